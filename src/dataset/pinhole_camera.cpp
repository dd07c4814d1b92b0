// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/pinhole_camera.h>

#include "core/fail.h"
#include "files/yaml_config.h"

#include <cmath>
#include <vector>

namespace pcl_semantic {

namespace {

void
refuseDistortion(const YamlMap& map, const std::string& key)
{
  std::vector<double> values;
  if (map.isMap(key))
    map.requireMap(key).get("data", values);
  else
    map.get(key, values);
  for (const double value : values)
    if (value != 0.0)
      fail<BadInputException>(
          map.where(key), ": images have to be undistorted, with coefficients of 0");
}

PinholeCamera
cameraOfMatrix(const std::vector<double>& K, const std::string& where)
{
  if (K.size() != 9 || K[1] != 0.0 || K[8] != 1.0)
    fail<BadInputException>(where,
                            ": is no camera matrix, expected fx 0 cx 0 fy cy 0 0 1");
  return {K[0], K[4], K[2], K[5]};
}

} // namespace

void
PinholeCamera::validate() const
{
  if (!(fx > 0.0 && fy > 0.0 && std::isfinite(fx) && std::isfinite(fy) &&
        std::isfinite(cx) && std::isfinite(cy)))
    fail<InvalidParameterException>("camera: fx ", fx, ", fy ", fy, ", cx ", cx,
                                    ", cy ", cy,
                                    " px, expected positive focal lengths");
}

PinholeCamera
readPinholeCamera(const std::string& path)
{
  const YamlMap file = YamlMap::load(path);
  PinholeCamera camera;
  if (file.isMap("cam0")) {
    const YamlMap first = file.requireMap("cam0");
    const auto values = first.require<std::vector<double>>("intrinsics");
    if (values.size() != 4)
      fail<BadInputException>(first.where("intrinsics"), ": expected fx, fy, cx, cy");
    refuseDistortion(first, "distortion_coeffs");
    camera = {values[0], values[1], values[2], values[3]};
  }
  else {
    const bool is_matrix = file.isMap("camera_matrix");
    const std::string key = is_matrix ? "camera_matrix" : file.has("K") ? "K" : "k";
    if (!file.has(key))
      fail<BadInputException>(
          path, ": has neither camera_matrix or K (camera_info) nor cam0 (Kalibr)");
    const auto K = is_matrix ? file.requireMap(key).require<std::vector<double>>("data")
                             : file.require<std::vector<double>>(key);
    for (const char* const name : {"distortion_coefficients", "D", "d"})
      if (file.has(name))
        refuseDistortion(file, name);
    camera = cameraOfMatrix(K, file.where(key));
  }
  readFrom(path, [&] { camera.validate(); });
  return camera;
}

} // namespace pcl_semantic
