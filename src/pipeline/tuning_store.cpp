// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/tuning_store.h>

#include <nlohmann/json.hpp>

#include <filesystem>

namespace pcl_semantic {

namespace {

using Json = nlohmann::json;

// Every parameter but the number of threads, on which no result depends. As an object:
// a parameter that a later version adds makes another key.
std::string
parametersAsText(const MapperConfig& config)
{
  MapperConfig copy = config;
  Json json;
  for (const ConfigParameter& parameter : parametersOf(copy))
    if (parameter.name != "threads")
      json[parameter.name] = parameter.text();
  return json.dump();
}

// [truth, prediction, pixels, truth, ...] of what is not 0.
Json
jsonOf(const ConfusionMatrix& confusion)
{
  Json json = Json::array();
  for (int truth = 0; truth <= confusion.classes(); ++truth)
    for (int label = 0; label <= confusion.classes(); ++label)
      if (const auto count = confusion(Label(truth), Label(label)))
        for (const std::uint64_t number :
             {std::uint64_t(truth), std::uint64_t(label), count})
          json.push_back(number);
  return json;
}

void
readCounts(const Json& json, ConfusionMatrix& confusion)
{
  const auto numbers = json.get<std::vector<std::uint64_t>>();
  if (numbers.size() % 3 != 0)
    throw std::runtime_error("counts are no triples");
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    if (numbers[i] > 255 || numbers[i + 1] > 255)
      throw std::runtime_error("a label is beyond 255");
    confusion.add(Label(numbers[i]), Label(numbers[i + 1]), numbers[i + 2]);
  }
}

Json
jsonOf(const TuningCounts& counts)
{
  return {{"network", jsonOf(counts.network)},
          {"fused", jsonOf(counts.fused)},
          {"refined", jsonOf(counts.refined)}};
}

void
readCounts(const Json& json, TuningCounts& counts)
{
  readCounts(json.at("network"), counts.network);
  readCounts(json.at("fused"), counts.fused);
  readCounts(json.at("refined"), counts.refined);
}

} // namespace

TuningStore::TuningStore(const std::string& path, const std::string& data, int classes)
    : path_(path), classes_(classes)
{
  if (path.empty())
    return;
  std::error_code error;
  if (std::filesystem::exists(path, error) &&
      std::filesystem::file_size(path, error) > 0)
    read(data);
  else
    writeTextFile(path, Json{{"data", data}}.dump() + "\n");
  stream_.open(path, std::ios::app);
  if (!stream_)
    PCL_THROW_EXCEPTION(OutputException, path << ": cannot be written");
}

void
TuningStore::read(const std::string& data)
{
  std::string kept; // what stays of the file: all but an unfinished last line
  const std::vector<std::uint8_t> bytes = readBytes(path_);
  const bool is_whole = bytes.back() == '\n';
  std::vector<TextLine> lines = readLines(path_);
  if (!is_whole)
    lines.pop_back();
  for (const TextLine& line : lines) {
    kept += line.text + "\n";
    try {
      const Json json = Json::parse(line.text);
      if (line.number == 1) {
        if (json.at("data").get<std::string>() != data)
          PCL_THROW_EXCEPTION(
              BadInputException,
              path_ << ": holds other runs: "
                    << changeOfRun(json.at("data").get<std::string>(), data)
                    << "; name another file, or remove it");
        continue;
      }
      TuningResult result(classes_);
      readCounts(json.at("at_depth"), result.at_depth);
      readCounts(json.at("rendered"), result.rendered);
      results_.emplace(Key(json.at("parameters").dump(), json.at("sequence")), result);
    }
    catch (const BadInputException&) {
      throw;
    }
    catch (const std::exception&) {
      PCL_THROW_EXCEPTION(BadInputException, placeOf(path_, line.number)
                                                 << ": is no run of a search");
    }
  }
  known_ = results_.size();
  if (!is_whole)
    writeTextFile(path_, kept.empty() ? Json{{"data", data}}.dump() + "\n" : kept);
}

const TuningResult*
TuningStore::find(const MapperConfig& config, const std::string& sequence) const
{
  const auto found = results_.find({parametersAsText(config), sequence});
  return found == results_.end() ? nullptr : &found->second;
}

void
TuningStore::add(const MapperConfig& config, const std::string& sequence,
                 const TuningResult& result)
{
  const std::string parameters = parametersAsText(config);
  results_.emplace(Key(parameters, sequence), result);
  if (path_.empty())
    return;
  stream_ << Json{{"parameters", Json::parse(parameters)},
                  {"sequence", sequence},
                  {"at_depth", jsonOf(result.at_depth)},
                  {"rendered", jsonOf(result.rendered)}}
                 .dump()
          << "\n"
          << std::flush;
  if (!stream_)
    PCL_THROW_EXCEPTION(OutputException, path_ << ": cannot be written");
}

} // namespace pcl_semantic
