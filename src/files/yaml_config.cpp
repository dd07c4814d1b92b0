// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_config.h"

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <yaml-cpp/yaml.h>

#include <set>

namespace pcl_semantic {

struct YamlMap::Impl {
  std::string path;
  YAML::Node node;
  std::set<std::string> asked;

  std::string
  where(const YAML::Node& at) const
  {
    return atLine(path, at.Mark().line + 1);
  }

  // The key's own node, for its line number; yaml-cpp's lookup returns only the value.
  YAML::Node
  keyNode(const std::string& key) const
  {
    for (const auto& entry : node)
      if (entry.first.Scalar() == key)
        return entry.first;
    return node;
  }

  static std::shared_ptr<Impl>
  make(const std::string& path, const YAML::Node& node)
  {
    auto impl = std::make_shared<Impl>();
    impl->path = path;
    impl->node.reset(node);
    if (!node.IsMap())
      badInput(impl->where(node), ": expected 'key: value' lines");
    std::set<std::string> keys;
    for (const auto& entry : node) {
      if (!entry.first.IsScalar())
        badInput(impl->where(entry.first), ": a key has to be a word");
      if (!keys.insert(entry.first.Scalar()).second)
        badInput(impl->where(entry.first), ": key '", entry.first.Scalar(),
                 "' is there twice");
    }
    return impl;
  }
};

namespace {

// The text of a file for yaml-cpp, which would silently ignore a second document.
std::string
readDocument(const std::string& path)
{
  std::string text;
  bool begun = false;
  std::vector<TextLine> lines = readLines(path);
  // `rostopic echo` ends each message with a marker.
  while (lines.size() > 1 && (lines.back().text.empty() || lines.back().text == "---"))
    lines.pop_back();
  for (const TextLine& line : lines) {
    const bool is_directive = line.text.rfind("%YAML", 0) == 0;
    const bool is_marker = line.text.rfind("---", 0) == 0;
    if (is_marker && begun)
      badInput(atLine(path, line.number), ": a second document begins, expected one");
    begun = begun || is_marker ||
            !(line.text.empty() || is_directive || line.text[0] == '#');
    text += (is_directive ? "" : line.text) + "\n";
  }
  return text;
}

} // namespace

YamlMap
YamlMap::load(const std::string& path)
{
  const std::string text = readDocument(path);
  try {
    const YAML::Node document = YAML::Load(text);
    if (document.IsNull()) // has no line number
      badInput(path, ": expected 'key: value' lines");
    return YamlMap(Impl::make(path, document));
  }
  catch (const YAML::Exception& error) {
    badInput(atLine(path, error.mark.line + 1), ": ", error.msg);
  }
}

bool
YamlMap::has(const std::string& key) const
{
  impl_->asked.insert(key);
  return static_cast<bool>(impl_->node[key]);
}

template <typename T>
bool
YamlMap::get(const std::string& key, T& value) const
{
  if (!has(key))
    return false;
  try {
    // yaml-cpp would convert a missing value to the word "null".
    const YAML::Node node = impl_->node[key];
    if (node.IsNull())
      throw YAML::TypedBadConversion<T>(node.Mark());
    value = node.as<T>();
  }
  catch (const YAML::Exception&) {
    badInput(where(key), ": the value of '", key, "' is not of the expected type");
  }
  return true;
}

template bool YamlMap::get(const std::string&, bool&) const;
template bool YamlMap::get(const std::string&, int&) const;
template bool YamlMap::get(const std::string&, double&) const;
template bool YamlMap::get(const std::string&, std::string&) const;
template bool YamlMap::get(const std::string&, std::vector<int>&) const;
template bool YamlMap::get(const std::string&, std::vector<double>&) const;
template bool YamlMap::get(const std::string&, std::vector<std::vector<double>>&) const;
template bool YamlMap::get(const std::string&, std::vector<std::string>&) const;

std::vector<YamlMap>
YamlMap::requireList(const std::string& key) const
{
  if (!has(key))
    throwMissing(key);
  const YAML::Node list = impl_->node[key];
  if (!list.IsSequence())
    badInput(where(key), ": '", key, "' has to be a list");
  std::vector<YamlMap> maps;
  for (const YAML::Node& entry : list)
    maps.push_back(YamlMap(Impl::make(impl_->path, entry)));
  return maps;
}

bool
YamlMap::isMap(const std::string& key) const
{
  return has(key) && impl_->node[key].IsMap();
}

YamlMap
YamlMap::requireMap(const std::string& key) const
{
  if (!has(key))
    throwMissing(key);
  return YamlMap(Impl::make(impl_->path, impl_->node[key]));
}

std::vector<std::string>
YamlMap::keys() const
{
  std::vector<std::string> keys;
  for (const auto& entry : impl_->node)
    keys.push_back(entry.first.Scalar());
  return keys;
}

std::string
YamlMap::where(const std::string& key) const
{
  return impl_->where(impl_->keyNode(key));
}

void
YamlMap::refuseUnknownKeys() const
{
  for (const auto& entry : impl_->node)
    if (!impl_->asked.count(entry.first.Scalar()))
      badInput(impl_->where(entry.first), ": key '", entry.first.Scalar(),
               "' is not known");
}

void
YamlMap::throwMissing(const std::string& key) const
{
  badInput(impl_->where(impl_->node), ": key '", key, "' is missing");
}

} // namespace pcl_semantic
