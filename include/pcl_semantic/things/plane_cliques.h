// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/things/plane_extraction.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Planes as cliques, cut into pieces by the cubes of a grid: surfaces of
 * different classes often lie in one plane, as a road and a sidewalk, but seldom within
 * a metre. Points of no plane belong to no clique. */
class PlaneCliques : public CliqueGenerator {
public:
  static constexpr double default_edge = 1.0; ///< [m]

  /** \param[in] edge of a cube [m]; infinite = whole planes
   * \param[in] parameters of the planes
   * \throws InvalidParameterException unless the edge is positive, or as
   * PlaneParameters::validate() */
  explicit PlaneCliques(double edge = default_edge,
                        const PlaneParameters& parameters = PlaneParameters());

  /** \brief Groups the points.
   * \return cliques in the order of their planes; those of a plane in the order of
   * their cubes
   * \throws BadInputException as PlaneExtraction and CubeCliques */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  double edge_;
  PlaneParameters parameters_;
};

} // namespace pcl_semantic
