// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// The shortest of 15 to 17 significant digits that reads back to the same bits, with a point whatever the locale.
std::string number_text(double value);

/// Reads the whole of `text` as a finite decimal number ("1e-3", ".5", "-2"), with a point whatever the locale.
/// False for anything else: blanks, "0.1x", "0x10", "nan", "inf", "1e999".
bool parse_number(const std::string& text, double* value);

}  // namespace allan_lio
