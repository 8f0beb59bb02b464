// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/number_text.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace allan_lio {

std::string number_text(double value) {
  std::string text;
  for (int digits = 15; digits <= 17; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << value;
    text = out.str();
    double back = 0.0;
    if (parse_number(text, &back) && back == value) break;
  }
  return text;
}

bool parse_number(const std::string& text, double* value) {
  // The stream would also take blanks in front and hexadecimal numbers, depending on the library.
  if (text.empty() || text.find_first_not_of("0123456789+-.eE") != std::string::npos) return false;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double read = 0.0;
  if (!(in >> read) || in.peek() != std::istringstream::traits_type::eof() || !std::isfinite(read)) return false;
  *value = read;
  return true;
}

}  // namespace allan_lio
