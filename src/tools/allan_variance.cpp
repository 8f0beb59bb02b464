// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <stdexcept>
#include <thread>

#include "allan_lio/calib/record_analysis.h"
#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/allan_report.h"
#include "allan_lio/io/imu_csv.h"
#include "allan_lio/io/run_program.h"
#include "allan_lio/io/whole_file.h"
#include "allan_lio/ros/imu_bag.h"
#include "allan_lio/ros/program_files.h"

namespace {

using namespace allan_lio;
namespace fs = std::filesystem;

constexpr int kBadInput = 2, kIncomplete = 1;

const std::map<std::string, FitMethod> kMethods = {{"ls", FitMethod::kLeastSquares}, {"ml", FitMethod::kLikelihood}};
const std::map<std::string, BiasOutput> kBiases = {
    {"flat", BiasOutput::kFlat}, {"gauss_markov", BiasOutput::kGaussMarkov}, {"random_walk", BiasOutput::kRandomWalk}};

struct Arguments {
  ImuBagSource bag;
  std::string csv, time_unit, gyro_unit, accel_unit, out, table, plot, method = "ls", bias = "flat";
  double rate = 0.0;  // [Hz]; 0: by the stamps
  double from = 0.0;  // [s] of the averaging times that are fitted; 0: found
  int threads = 0;    // 0: one a processor
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("--bag", a.bag.bags, "bag file; give it again for more, in the order of time");
  app.add_option("--topic", a.bag.topic, "sensor_msgs/Imu topic of the bags (default: the only one that there is)");
  app.add_option("--temperature-topic", a.bag.temperature_topic, "sensor_msgs/Temperature topic of the bags");
  app.add_option("--csv", a.csv,
                 "table of readings, '-' for the standard input; columns by the names in its header, or "
                 "time, gyro x y z, accelerometer x y z, or the same without time");
  app.add_option("--rate", a.rate, "sampling rate [Hz] of readings without stamps, or with stamps not to be trusted")
      ->check(CLI::PositiveNumber);
  app.add_option("--time-unit", a.time_unit, "of the table's time: s, ms, us or ns (default: told by the table)")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  app.add_option("--gyro-unit", a.gyro_unit, "unit of the gyro's readings (default: by the table's header, or rad/s)");
  app.add_option("--accel-unit", a.accel_unit,
                 "unit of the accelerometer's readings (default: by the table's header, or g and m/s^2 told apart by "
                 "the mean length)");
  app.add_option("--out", a.out, "the noise as a file for config/imu/")->required();
  app.add_option("--table", a.table, "Allan deviations with their 95 % bands and the fitted models as CSV");
  app.add_option("--plot", a.plot, "the curves as PNG");
  app.add_option("--method", a.method, "ls: least squares of the Allan variances; ml: maximum likelihood (default ls)")
      ->check(CLI::IsMember({"ls", "ml"}));
  app.add_option("--bias", a.bias,
                 "what the bias is written as: flat: the flat part of the curve; gauss_markov: the Gauss-Markov bias "
                 "of the fit; random_walk: K (default flat)")
      ->check(CLI::IsMember({"flat", "gauss_markov", "random_walk"}));
  app.add_option("--from", a.from,
                 "shortest averaging time that is fitted [s]; without it the fit begins where the model starts to hold")
      ->check(CLI::PositiveNumber);
  app.add_option("--threads", a.threads, "threads; the result does not depend on them")->check(CLI::Range(1, 64));
}

double factor_of(const std::string& unit, Dimension dimension, const std::string& option) {
  const UnitConversion conversion = convert_unit(unit, dimension);
  if (!conversion.ok()) throw std::invalid_argument(option + ": " + conversion.error);
  return conversion.to_si;
}

/// Readings of about 1 at rest are g, about 10 m/s^2.
double accel_factor_by_length(const StaticRecord& record) {
  const double length = std::hypot(std::hypot(record.mean(3), record.mean(4)), record.mean(5));
  if (length > 0.5 && length < 2.0) return factor_of("g", Dimension::kAcceleration, "");
  if (length > 5.0 && length < 20.0) return 1.0;
  throw std::invalid_argument("the mean specific force is " + rounded_text(length, 4) +
                              " long, which is neither g nor m/s^2 at rest: name its unit with --accel-unit");
}

/// What was read: the record in SI and where it came from.
struct Recording {
  explicit Recording(const StaticRecordOptions& options) : record(options) {}
  StaticRecord record;
  RecordOrigin origin;
  std::vector<std::string> troubles;  ///< why it is not all that it should be
};

/// Units asked for go before those that the table tells.
void set_units(const Arguments& a, const std::string& table_gyro, const std::string& table_accel,
               StaticRecord& record) {
  const std::string gyro = !a.gyro_unit.empty() ? a.gyro_unit : table_gyro.empty() ? "rad/s" : table_gyro;
  const std::string accel = !a.accel_unit.empty() ? a.accel_unit : table_accel;
  const double gyro_factor = factor_of(gyro, Dimension::kAngularRate, "gyro");
  record.set_units(gyro_factor, accel.empty() || accel == "auto"
                                    ? accel_factor_by_length(record)
                                    : factor_of(accel, Dimension::kAcceleration, "accelerometer"));
}

void read_table(const Arguments& a, Recording& recording) {
  ImuCsvOptions options;
  options.ignore_time = a.rate > 0.0;
  options.time_unit = a.time_unit;
  ImuCsvReader reader(a.csv, options);
  if (a.rate == 0.0 && !reader.has_time())
    throw std::invalid_argument(a.csv + " has no column of time: give the sampling rate with --rate");
  for (ImuSample sample; reader.next(sample);) recording.record.add(sample);
  recording.record.finish();
  recording.origin.name = a.csv == "-" ? "standard input" : fs::path(a.csv).filename().string();
  recording.origin.temperature = reader.temperature();
  if (!reader.note().empty()) recording.origin.remarks.push_back(reader.note());
  if (recording.record.tau0() > 0.0) set_units(a, reader.gyro_unit(), reader.accel_unit(), recording.record);
}

void read_bags(const Arguments& a, Recording& recording) {
  RecordOrigin& origin = recording.origin;
  const ImuBagOutcome outcome = read_imu_bags(a.bag, {[&](const ImuSample& sample) { recording.record.add(sample); },
                                                      [&](double value) { origin.temperature.add(value); }});
  recording.record.finish();
  for (const std::string& bag : a.bag.bags) origin.name += fs::path(bag).filename().string() + " ";
  origin.name += outcome.topic;
  recording.troubles = outcome.troubles;
  if (outcome.undecodable > 0)
    recording.troubles.push_back(std::to_string(outcome.undecodable) + " messages are too short for their type");
  if (recording.record.tau0() > 0.0) set_units(a, "", "", recording.record);
}

/// A directory under /tmp (or $TMPDIR) for what the script reads.
class PlotInput {
 public:
  PlotInput(const RecordAnalysis& analysis, const RecordOrigin& origin) {
    directory_ = (fs::temp_directory_path() / "allan_variance_XXXXXX").string();
    if (mkdtemp(&directory_[0]) == nullptr) throw std::runtime_error(directory_ + ": cannot be made");
    write_whole(table(), deviation_table(analysis));
    write_whole(fits(), fits_json(analysis, origin));
  }
  ~PlotInput() {
    std::error_code ignored;
    fs::remove_all(directory_, ignored);
  }
  PlotInput(const PlotInput&) = delete;
  PlotInput& operator=(const PlotInput&) = delete;

  std::string table() const { return directory_ + "/deviations.csv"; }
  std::string fits() const { return directory_ + "/fits.json"; }

 private:
  std::string directory_;
};

void plot(const std::string& script, const RecordAnalysis& analysis, const RecordOrigin& origin,
          const std::string& png) {
  const PlotInput input(analysis, origin);
  const ProgramOutcome drawn = run_program({script, "--table", input.table(), "--fits", input.fits(), "--out", png});
  if (drawn.status != 0) throw std::runtime_error(png + " was not drawn: " + script + " failed: " + drawn.errors);
}

void check_arguments(const Arguments& a) {
  if (a.bag.bags.empty() == a.csv.empty()) throw std::invalid_argument("give either --bag or --csv");
  if (a.bag.bags.empty() && !(a.bag.topic + a.bag.temperature_topic).empty())
    throw std::invalid_argument("--topic and --temperature-topic need --bag");
  if (!a.gyro_unit.empty()) factor_of(a.gyro_unit, Dimension::kAngularRate, "--gyro-unit");
  if (!a.accel_unit.empty() && a.accel_unit != "auto")
    factor_of(a.accel_unit, Dimension::kAcceleration, "--accel-unit");
  for (const std::string& path : {a.out, a.table, a.plot})
    if (!path.empty()) check_writable(path);
}

int run(const Arguments& a) {
  check_arguments(a);
  const std::string script = a.plot.empty() ? "" : package_script("plot_allan");
  const int threads = a.threads > 0 ? a.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  StaticRecordOptions options;
  options.rate = a.rate;
  options.threads = threads;
  Recording recording(options);
  a.csv.empty() ? read_bags(a, recording) : read_table(a, recording);
  RecordOrigin& origin = recording.origin;
  if (recording.record.tau0() == 0.0) throw std::invalid_argument(origin.name + ": holds no two usable samples");
  for (const std::string& remark : recording.record.remarks()) origin.remarks.push_back(remark);
  const std::string motion = recording.record.motion();
  if (!motion.empty()) origin.remarks.push_back("WARNING: " + motion);
  std::cout << record_text(recording.record, origin) << std::flush;

  const RecordAnalysis analysis = analyse_record(recording.record, kMethods.at(a.method), threads, a.from);
  const NoiseYaml yaml = noise_yaml(analysis, origin, kBiases.at(a.bias));
  write_whole(a.out, yaml.text);
  if (!a.table.empty()) write_whole(a.table, deviation_table(analysis));
  std::cout << fits_text(analysis) << std::flush;
  if (!a.plot.empty()) plot(script, analysis, origin, a.plot);

  if (!motion.empty()) std::cerr << "allan_variance: " << motion << '\n';
  for (const std::string& trouble : recording.troubles) std::cerr << "allan_variance: " << trouble << '\n';
  for (const std::string& sentence : yaml.missing)
    std::cerr << "allan_variance: " << sentence << "; it is commented out in " << a.out << '\n';
  return recording.troubles.empty() && yaml.missing.empty() ? 0 : kIncomplete;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Noise of an IMU from a record at rest: overlapping Allan variance, and the fit of quantisation, white noise, "
      "bias instability and random walk with 95 % intervals.\n"
      "Exit status: 0; 1 if the record does not show a figure that --out needs, or is damaged; 2 for bad input."};
  std::signal(SIGPIPE, SIG_IGN);  // whoever reads only the first lines of the report still gets the files
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
    return run(arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "allan_variance: " << error.what() << '\n';
  } catch (const std::exception& error) {
    std::cerr << "allan_variance: " << error.what() << '\n';
  }
  return kBadInput;
}
