// SPDX-License-Identifier: BSD-3-Clause
#include "default_label_set.h"
#include "map_extras.h"
#include "map_source.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/io/labelled_cloud_file.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <filesystem>

namespace pcl_semantic::tool {

namespace {

class CloudSource : public MapSource {
public:
  explicit CloudSource(const MapArguments& arguments)
      : arguments_(arguments), clouds_(arguments.clouds, arguments.sequence.files.times)
  {
    std::error_code error;
    if (std::filesystem::equivalent(arguments.poses,
                                    arguments.output + "/trajectory.txt", error))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--poses is where --output puts its own trajectory");
    if (std::filesystem::equivalent(arguments.clouds, arguments.output, error))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--output holds the clouds; maps need a folder of their own");
    poses_ = arguments.poses;
    run_.label_set = readLabelSetOrDefault(arguments.label_set);
    run_.config = arguments.parameters;
    positions_ = chooseClouds(arguments.clouds, clouds_, arguments.frames);
    for (const std::size_t i : positions_)
      run_.frames.push_back(clouds_.frameNumber(i));
    setSensor();
    if (run_.camera.width == 0 && !arguments.also.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--also is for frames of a camera");
    run_.inputs = inputsOf(arguments.sequence);
    run_.inputs.insert(run_.inputs.end(),
                       {{"clouds", arguments.clouds},
                        {"sensor", arguments.sensor},
                        {"poses", poses_},
                        {"label_calibration", arguments.label_calibration},
                        {"clique_calibration", arguments.clique_calibration}});
    calibrations_ = readCalibrations(arguments, run_.label_set);
    extras_ = makeExtras(arguments, nullptr, positions_);
  }

  std::vector<FrameTime>
  times() const override
  {
    std::vector<FrameTime> times;
    for (const std::size_t i : positions_)
      times.push_back({clouds_.frameNumber(i), clouds_.timestamp(i)});
    return times;
  }

  std::unique_ptr<PoseSource>
  openPoses() const override
  {
    return arguments_.sensor == "own" ? readSensorPoses(poses_)
                                      : readPoses(poses_, run_.T_camera0_camera);
  }

  MappedFrame
  map(std::size_t i, SemanticMapper& mapper) override
  {
    const CloudFrame frame =
        clouds_.frame(positions_[i], run_.label_set.size(),
                      float(arguments_.parameters.label_confidence));
    if (frame.distributions.empty() && !frame.cloud->empty() && !told_of_labels_) {
      warn(clouds_.path(positions_[i]) +
           ": has no field 'label' or 'probability': it gives the map no labels");
      told_of_labels_ = true;
    }
    return mapper.process(frame);
  }

private:
  std::unique_ptr<SemanticMapper>
  newMapper(std::unique_ptr<PoseSource> poses,
            std::shared_ptr<BlockStore> store) override
  {
    std::optional<StereoCamera> camera;
    if (run_.camera.width > 0)
      camera = run_.camera;
    return std::make_unique<SemanticMapper>(camera, run_.label_set, run_.config,
                                            std::move(poses), std::move(store));
  }

  // Where the sensor is in camera 0, and its camera.
  void
  setSensor()
  {
    const ImagePairFiles& files = arguments_.sequence.files;
    if (arguments_.sensor == "own")
      run_.T_camera0_camera = worldFromFirstCamera().inverse(); // it looks along x
    else if (arguments_.sensor == "laser")
      run_.T_camera0_camera = scannerOf(files.calibration);
    else {
      const RectifiedPair pair = readRectifiedPair(
          {files.calibration, files.extrinsics}, firstCloud(),
          arguments_.sensor == "grey" ? KittiCameras::grey : KittiCameras::colour);
      run_.camera = pair.camera;
      run_.T_camera0_camera = pair.T_camera0_camera;
    }
  }

  static Eigen::Isometry3d
  scannerOf(const std::string& calibration)
  {
    const auto read = readKittiCalibration(calibration, KittiCameras::colour);
    if (!read.T_camera0_velodyne)
      PCL_THROW_EXCEPTION(BadInputException,
                          calibration << ": has no row 'Tr', expected the pose of the "
                                         "laser scanner");
    return *read.T_camera0_velodyne;
  }

  // Its size is that of the camera's images.
  SizedFile
  firstCloud() const
  {
    const std::string& path = clouds_.path(positions_.front());
    const auto cloud = readLabelledCloud(path).cloud;
    if (!cloud->isOrganized())
      PCL_THROW_EXCEPTION(BadInputException,
                          path << ": is no organized cloud, expected one as the "
                                  "camera's images are (or --sensor laser)");
    return {{int(cloud->width), int(cloud->height)}, path};
  }

  MapArguments arguments_;
  CloudSequence clouds_;
  std::vector<std::size_t> positions_;
  bool told_of_labels_ = false; // a cloud had none
};

} // namespace

std::unique_ptr<MapSource>
openCloudSource(const MapArguments& arguments)
{
  return std::make_unique<CloudSource>(arguments);
}

} // namespace pcl_semantic::tool
