# SPDX-License-Identifier: BSD-3-Clause
"""The laboratory: ground truth, scores, figures and result tables of maps (README.md)."""
