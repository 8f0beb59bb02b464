// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace allan_lio {

/// A line of a file without its newline. The text is valid until the next line is read.
struct TextLine {
  const char* begin = nullptr;
  const char* end = nullptr;
  std::size_t number = 0;  ///< from 1
  bool closed = false;     ///< by a newline

  std::string text() const { return std::string(begin, end); }
};

/// Reads a file line by line through a large buffer. Mistakes are std::runtime_errors that name the file.
class LineReader {
 public:
  /// "-" is the standard input.
  explicit LineReader(const std::string& path);

  const std::string& name() const { return name_; }

  bool next(TextLine& line);

 private:
  void fill();

  struct CloseFile {
    void operator()(std::FILE* file) const;
  };

  std::string name_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of what is not delivered yet in buffer_
  bool at_end_ = false;
  std::size_t number_ = 0;
};

}  // namespace allan_lio
