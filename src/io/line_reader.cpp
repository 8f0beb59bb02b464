// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/line_reader.h"

#include <cstring>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr std::size_t kBufferSize = 1U << 16U;   // [bytes]
constexpr std::size_t kLongestLine = 1U << 20U;  // [bytes]

}  // namespace

void LineReader::CloseFile::operator()(std::FILE* file) const {
  if (file != stdin) std::fclose(file);
}

LineReader::LineReader(const std::string& path)
    : name_(path == "-" ? "standard input" : path),
      file_(path == "-" ? stdin : std::fopen(path.c_str(), "rb")),
      buffer_(kBufferSize) {
  if (!file_) throw std::runtime_error(name_ + ": cannot be opened");
}

void LineReader::fill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ == kLongestLine)
    throw std::runtime_error(name_ + ":" + std::to_string(number_ + 1) + ": the line is too long to be a table's");
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  const std::size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (got == 0 && std::ferror(file_.get())) throw std::runtime_error(name_ + ": cannot be read");
  at_end_ = got == 0;
  end_ += got;
}

bool LineReader::next(TextLine& line) {
  for (std::size_t searched = 0;;) {
    const char* const from = buffer_.data() + begin_;
    const void* const newline = std::memchr(from + searched, '\n', end_ - begin_ - searched);
    if (newline == nullptr && !at_end_) {
      searched = end_ - begin_;
      fill();
      continue;
    }
    if (newline == nullptr && begin_ == end_) return false;
    line.begin = from;
    line.end = newline != nullptr ? static_cast<const char*>(newline) : buffer_.data() + end_;
    line.closed = newline != nullptr;
    line.number = ++number_;
    begin_ = static_cast<std::size_t>(line.end - buffer_.data()) + (line.closed ? 1 : 0);
    return true;
  }
}

}  // namespace allan_lio
