# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tune_report is made of: reading (tuning_data), comparing with the truth (trajectories), drawing, the page."""
