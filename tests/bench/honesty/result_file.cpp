// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/honesty/result_file.h"

#include <fstream>
#include <utility>

#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {

namespace fs = std::filesystem;

ResultFile::ResultFile(fs::path file, const std::string& title) : file_(std::move(file)) {
  if (fs::exists(file_)) {
    Load(title);
  } else {
    WriteFileAtomically(file_, title + "\n");
  }
}

void ResultFile::Load(const std::string& title) {
  constexpr std::uint64_t kMaxBytes = 4ULL << 30;
  const std::string text = ReadTextFile(file_, kMaxBytes);
  const std::size_t whole = text.rfind('\n') + 1;  // 0 when there is no complete line
  if (text.substr(0, std::min(whole, text.find('\n'))) != title) {
    throw InputError(file_, "belongs to another seed or map; begin anew with --restart");
  }
  std::size_t start = title.size() + 1;
  for (int line = 2; start < whole; ++line) {
    const std::size_t end = text.find('\n', start);
    try {
      records_.push_back(ParseFrameRecord(text.substr(start, end - start)));
    } catch (const std::exception&) {
      throw InputError(file_, line, "is damaged; begin anew with --restart");
    }
    if (records_.back().frame != static_cast<int>(records_.size()) - 1) {
      throw InputError(file_, line, "is not the next frame; begin anew with --restart");
    }
    start = end + 1;
  }
  if (whole < text.size()) {
    fs::resize_file(file_, whole);
  }
}

void ResultFile::Append(const std::vector<FrameRecord>& records) {
  std::string lines;
  for (const FrameRecord& record : records) {
    lines += ToJsonLine(record) + "\n";
  }
  std::ofstream out(file_, std::ios::binary | std::ios::app);
  out << lines;
  if (!out.flush()) {
    throw InputError(file_, "cannot be written; is the disk full?");
  }
  records_.insert(records_.end(), records.begin(), records.end());
}

}  // namespace floorloc
