// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slurm_cluster.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "child_process.h"

namespace allan_lio {
namespace {

constexpr int kStartSeconds = 60, kStopSeconds = 10;
const char* const kDaemonPath = "/usr/sbin:/sbin:/usr/local/sbin:";

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// Ports that nobody listens on; all held at once while they are sought, so that they differ.
std::vector<int> free_ports(int count) {
  std::vector<int> sockets, ports;
  for (int i = 0; i < count; ++i) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    socklen_t size = sizeof address;
    sockets.push_back(socket(AF_INET, SOCK_STREAM, 0));
    if (bind(sockets.back(), reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        getsockname(sockets.back(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no free port");
    ports.push_back(ntohs(address.sin_port));
  }
  for (const int s : sockets) close(s);
  return ports;
}

}  // namespace

bool SlurmCluster::installed() {
  const ScopedVariable path("PATH", kDaemonPath + std::string(getenv("PATH")));
  return run_command("command -v slurmctld && command -v slurmd && command -v sbatch").status == 0;
}

SlurmCluster::SlurmCluster() {
  conf_ = std::make_unique<ScopedVariable>("SLURM_CONF", directory_.file("slurm.conf"));
  path_ = std::make_unique<ScopedVariable>("PATH", kDaemonPath + std::string(getenv("PATH")));
  write_configuration();
  try {
    start({"slurmctld", "-D", "-i", "-f", directory_.file("slurm.conf")}, "slurmctld.log");
    start({"slurmd", "-D", "-f", directory_.file("slurm.conf"), "-N", "node"}, "slurmd.log");
    wait_for_node();
  } catch (...) {
    stop();
    throw;
  }
}

SlurmCluster::~SlurmCluster() { stop(); }

void SlurmCluster::write_configuration() const {
  char host[256] = {};
  if (gethostname(host, sizeof host - 1) != 0) throw std::runtime_error("no host name");
  const std::string user = getpwuid(getuid())->pw_name, here = directory_.path();
  const std::vector<int> ports = free_ports(2);
  for (const char* name : {"state", "spool"}) std::filesystem::create_directories(directory_.file(name));
  std::ofstream(directory_.file("slurm.conf"))
      << "ClusterName=test\nSlurmctldHost=localhost(127.0.0.1)\nSlurmUser=" << user << "\nSlurmdUser=" << user
      << "\nSlurmctldPort=" << ports[0] << "\nSlurmdPort=" << ports[1]
      << "\nAuthType=auth/none\nCredType=cred/none\nProctrackType=proctrack/pgid\nTaskPlugin=task/none\n"
         "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nSwitchType=switch/none\nMpiDefault=none\n"
         "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\nReturnToService=2\n"
         "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0\nKillWait=1\n"
      << "StateSaveLocation=" << here << "/state\nSlurmdSpoolDir=" << here << "/spool\nSlurmctldPidFile=" << here
      << "/slurmctld.pid\nSlurmdPidFile=" << here << "/slurmd.pid\nNodeName=node NodeHostname=" << host
      << " NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN\nPartitionName=all Nodes=node Default=YES MaxTime=INFINITE\n";
}

void SlurmCluster::start(const std::vector<std::string>& command, const std::string& log) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::string log_path = directory_.file(log);
  const pid_t test = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start " + command[0]);
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int out = open(log_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (getppid() != test || dup2(out, STDOUT_FILENO) < 0 || dup2(out, STDERR_FILENO) < 0) _exit(1);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  daemons_.push_back(child);
}

void SlurmCluster::wait_for_node() const {
  for (int i = 0; i < kStartSeconds * 10; ++i) {
    if (run_command("sinfo --noheader --format=%T").text == "idle\n") return;
    sleep_ms(100);
  }
  throw std::runtime_error("the Slurm node does not come up:\n" + contents_of(directory_.file("slurmctld.log")) +
                           contents_of(directory_.file("slurmd.log")));
}

void SlurmCluster::stop() {
  // Jobs first: their processes are slurmd's to end.
  run_command("timeout 5 scancel --state=PENDING --user=" + std::to_string(getuid()) +
              "; timeout 5 scancel --signal=KILL --state=RUNNING --user=" + std::to_string(getuid()));
  for (int i = 0; i < 20 && !run_command("timeout 5 squeue --noheader").text.empty(); ++i) sleep_ms(100);
  for (auto daemon = daemons_.rbegin(); daemon != daemons_.rend(); ++daemon) {
    kill(*daemon, SIGTERM);
    for (int i = 0; i < kStopSeconds * 20 && waitpid(*daemon, nullptr, WNOHANG) == 0; ++i) {
      if (i == kStopSeconds * 20 - 20) kill(*daemon, SIGKILL);
      sleep_ms(50);
    }
  }
  daemons_.clear();
}

}  // namespace allan_lio
