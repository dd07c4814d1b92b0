/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/version.h>

#include <cmath>
#include <iostream>

namespace ps = pcl_semantic;

namespace {

int failures = 0;

void
check(bool holds, const char* what)
{
  if (!holds) {
    std::cerr << "downstream: wrong: " << what << "\n";
    ++failures;
  }
}

void
checkDistributions()
{
  ps::LabelDistributions distributions(3, 2);
  distributions.setLabel(0, 2, 0.8f);
  distributions.matrix().col(1) << 2.0f, 1.0f, 1.0f;
  distributions.normalize();
  check(distributions.mapLabel(0) == 2, "label of the first point");
  check(distributions.mapLabel(1) == 1, "label of the second point");
  check(std::abs(distributions.matrix()(0, 1) - 0.5f) < 1e-6f, "normalised value");
}

// Exceptions and their types have to survive the border of the shared library.
void
checkErrors()
{
  try {
    ps::LabelSet({{"road", {}}, {"road", {}}});
    check(false, "a class name used twice was accepted");
  }
  catch (const ps::InvalidParameterException& error) {
    check(std::string(error.what()).find("road") != std::string::npos,
          "the message names the class");
  }
}

} // namespace

int
main()
{
  checkDistributions();
  checkErrors();
  std::cout << "downstream of pcl_semantic " << PCL_SEMANTIC_VERSION << ": "
            << (failures == 0 ? "works" : "fails") << "\n";
  return failures == 0 ? 0 : 1;
}
