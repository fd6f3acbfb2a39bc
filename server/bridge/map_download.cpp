// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/map_download.h"

#include <httplib.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kConnectTime = std::chrono::seconds(10);
constexpr auto kSilence = std::chrono::seconds(30);

struct Link {
  std::string server;  // scheme, host and port
  std::string target;
};

Link ParseLink(const std::string& link, const DownloadOptions& options) {
  const bool is_web = link.starts_with("http://") || link.starts_with("https://");
  const bool clean = std::all_of(link.begin(), link.end(), [](char c) { return c > ' ' && c < 127; });
  const std::size_t host = std::min(link.find("://"), link.size() - 3) + 3;
  const std::size_t path = std::min(link.find('/', host), link.size());
  if (!is_web || !clean || path == host || link.substr(host, path - host).find('@') != std::string::npos) {
    throw std::runtime_error("mapDownloadLink must be an http or https link.");
  }
  const bool allowed = options.from.empty() || std::any_of(options.from.begin(), options.from.end(),
                                                           [&](const auto& from) { return link.starts_with(from); });
  if (!allowed) {
    throw std::runtime_error("mapDownloadLink begins with none of the bridge's downloads.from.");
  }
  const std::string target = link.substr(path, link.find('#', path) - path);
  return {link.substr(0, path), target.empty() ? "/" : target};
}

class Sha256 {
 public:
  Sha256() { Require(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr)); }
  void Add(const char* data, std::size_t size) { Require(EVP_DigestUpdate(context_.get(), data, size)); }
  std::string Text() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    unsigned int size = 0;
    Require(EVP_DigestFinal_ex(context_.get(), hash.data(), &size));
    std::string text;
    for (unsigned int i = 0; i < size; ++i) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      text += {kDigits[hash.at(i) / 16U], kDigits[hash.at(i) % 16U]};
    }
    return text;
  }

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  static void Require(int result) {
    if (result != 1) {
      throw std::runtime_error("the hash of the map could not be computed.");
    }
  }
  std::unique_ptr<EVP_MD_CTX, Free> context_{EVP_MD_CTX_new()};
};

std::filesystem::path MakeFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "floorloc-bridge-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("there is no room for a download below " + name + ".");
  }
  return name;
}

}  // namespace

DownloadedFile::DownloadedFile(const std::string& link, const DownloadOptions& options, const std::atomic<bool>& stop)
    : folder_(MakeFolder()) {
  try {
    Download(link, options, stop);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
    throw;
  }
}

DownloadedFile::~DownloadedFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void DownloadedFile::Download(const std::string& link, const DownloadOptions& options, const std::atomic<bool>& stop) {
  const Link parsed = ParseLink(link, options);
  httplib::Client http(parsed.server);
  http.set_connection_timeout(kConnectTime);
  http.set_read_timeout(kSilence);
  http.set_url_encode(false);
  std::ofstream file(path(), std::ios::binary);
  Sha256 hash;
  std::uint64_t bytes = 0;
  std::string trouble;
  int status = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(options.timeout_s);
  const auto take = [&](const char* data, std::size_t size) {
    bytes += size;
    if (bytes > options.max_bytes) {
      trouble = "The file at mapDownloadLink has more than " + std::to_string(options.max_bytes) + " bytes.";
    } else if (stop) {
      trouble = "The bridge was stopped.";
    } else if (Clock::now() > end) {
      trouble = "The download took longer than the bridge's downloads.timeout_s.";
    } else if (hash.Add(data, size); !file.write(data, static_cast<std::streamsize>(size))) {
      trouble = "The bridge has no room for the file at mapDownloadLink.";
    }
    return trouble.empty();
  };
  const httplib::Result result = http.Get(
      parsed.target, {},
      [&](const httplib::Response& response) {
        status = response.status;
        return status == 200;
      },
      take);
  if (status != 0 && status != 200) {
    throw std::runtime_error("The server of mapDownloadLink answers " + std::to_string(status) + ".");
  }
  if (trouble.empty() && !result) {
    trouble = "The server of mapDownloadLink does not answer: " + httplib::to_string(result.error()) + ".";
  }
  file.close();
  if (!trouble.empty() || !file) {
    throw std::runtime_error(trouble.empty() ? "The bridge has no room for the file at mapDownloadLink." : trouble);
  }
  sha256_ = hash.Text();
}

}  // namespace floorloc
