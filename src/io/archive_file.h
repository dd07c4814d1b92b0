// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace pcl_semantic {

/** \brief Makes an archive that appears under its name whole or not at all.
 * \param[in] make makes a file of the name that it is given
 * \throws OutputException if there is one already, or remains of one, which SQLite
 * would take for a part of the new one; of what \a make throws, the name is put right
 */
void makeArchiveFile(const std::string& path,
                     const std::function<void(const std::string&)>& make);

/** \throws BadInputException if a file is not there or cannot be opened */
void requireReadableFile(const std::string& path);

} // namespace pcl_semantic
