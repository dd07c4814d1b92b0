// SPDX-License-Identifier: BSD-3-Clause
#include "elas.h"
#include "semi_global_matcher.h"
#include "sgbm.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/stereo/disparity_engines.h>

namespace pcl_semantic {

namespace {

template <typename Engine>
std::unique_ptr<DisparityEstimator>
make(int disparities)
{
  typename Engine::Parameters parameters;
  parameters.disparities = disparities;
  return std::make_unique<Engine>(parameters);
}

} // namespace

const std::vector<std::string>&
disparityEngines()
{
  static const std::vector<std::string> names = {"sgm", "elas", "sgbm"};
  return names;
}

std::unique_ptr<DisparityEstimator>
makeDisparityEstimator(const std::string& name, int disparities)
{
  if (name == "sgm")
    return make<SemiGlobalMatcher>(disparities);
  if (name == "elas")
    return make<Elas>(disparities);
  if (name == "sgbm")
    return make<Sgbm>(disparities);
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      "the stereo engine is '" << name
                                               << "', expected sgm, elas or sgbm");
}

} // namespace pcl_semantic
