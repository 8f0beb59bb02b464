// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr int kStopLatency = 100;  // [ms]

/// A pipe whose ends close with it.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  }
  ~Pipe() {
    close_one(0);
    close_one(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write() { close_one(1); }

 private:
  void close_one(int i) {
    if (ends_[i] >= 0) close(ends_[i]);
    ends_[i] = -1;
  }
  int ends_[2] = {-1, -1};
};

pid_t start(const std::vector<std::string>& words, const Pipe& output, const Pipe& errors) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output.write_end(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors.write_end(), STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failure != 0) throw std::runtime_error(words[0] + ": cannot be started: " + std::strerror(failure));
  return child;
}

/// Takes what is there; false at the end.
bool take(int file, std::string& text) {
  char buffer[65536];
  const ssize_t size = read(file, buffer, sizeof buffer);
  if (size > 0) text.append(buffer, static_cast<std::size_t>(size));
  return size > 0 || (size < 0 && errno == EINTR);
}

}  // namespace

ProgramOutcome run_program(const std::vector<std::string>& words, const std::atomic<bool>* stop) {
  Pipe output, errors;
  const pid_t child = start(words, output, errors);
  output.close_write();
  errors.close_write();
  ProgramOutcome outcome;
  pollfd files[2] = {{output.read_end(), POLLIN, 0}, {errors.read_end(), POLLIN, 0}};
  bool told = false;
  while (files[0].fd >= 0 || files[1].fd >= 0) {
    files[0].revents = files[1].revents = 0;
    poll(files, 2, kStopLatency);
    if (stop != nullptr && *stop && !told) told = kill(child, SIGTERM) == 0;
    for (int i = 0; i < 2; ++i)
      if (files[i].fd >= 0 && files[i].revents != 0 && !take(files[i].fd, i == 0 ? outcome.output : outcome.errors))
        files[i].fd = -1;  // poll passes over it
  }
  int status = -1;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace allan_lio
