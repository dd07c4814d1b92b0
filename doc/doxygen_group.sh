#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# What Doxygen reads instead of a file: a public header's declarations are put into the
# group of its module (doc/modules.dox). No line moves.
case $1 in
  *include/pcl_semantic/*/*.h)
    module=${1##*include/pcl_semantic/}
    exec sed -e "s|^namespace PCL_SEMANTIC_EXPORT pcl_semantic {|& /** \\\\addtogroup ${module%%/*} */ /** @{ */|" \
      -e 's|^} // namespace pcl_semantic$|/** @} */ &|' "$1"
    ;;
esac
exec cat "$1"
