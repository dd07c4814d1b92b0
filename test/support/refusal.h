// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/thrown_message.h"

namespace pcl_semantic {

/** \brief EXPECTs that \a body throws exactly an \a Error whose single line contains \a
 * part. */
template <typename Error, typename Body>
void
expectRefusal(const std::string& part, Body&& body)
{
  EXPECT_TRUE(holds(thrownMessage<Error>(body), part));
}

} // namespace pcl_semantic
