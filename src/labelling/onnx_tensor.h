// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "wire_reader.h"

#include <string>

namespace pcl_semantic {

/** \brief Checks a TensorProto: it has exactly the data that its dimensions state, in
 * the file itself and of a type that OpenCV reads. \return its name \throws
 * BadModelException */
std::string checkOnnxTensor(WireReader message, const std::string& path);

} // namespace pcl_semantic
