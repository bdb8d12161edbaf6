#include "base/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;  // read at once

}  // namespace

struct Sha256::Context {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> digest{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  if (!context_->digest || EVP_DigestInit_ex(context_->digest.get(), EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL has no SHA-256");
}

Sha256::~Sha256() = default;

void Sha256::add(std::span<const std::byte> bytes) {
  if (EVP_DigestUpdate(context_->digest.get(), bytes.data(), bytes.size()) != 1)
    throw std::runtime_error("OpenSSL failed to compute SHA-256");
}

std::string Sha256::finish() {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_DigestFinal_ex(context_->digest.get(), digest.data(), &length) != 1)
    throw std::runtime_error("OpenSSL failed to compute SHA-256");
  std::string text;
  for (unsigned int i = 0; i < length; ++i) {
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

std::string sha256Hex(std::span<const std::byte> bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.finish();
}

std::string sha256File(const std::filesystem::path& file, const std::atomic<bool>* stop) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Error(ErrorKind::kInput, file.string() + ": no such file, or not a regular file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::kIo, file.string() + ": cannot be opened");
  Sha256 digest;
  std::vector<char> block(kBlockBytes);
  do {
    if (stop != nullptr && *stop) throw Stopped();
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    digest.add(std::as_bytes(std::span(block)).first(static_cast<std::size_t>(stream.gcount())));
  } while (stream);
  if (stream.bad()) throw Error(ErrorKind::kIo, file.string() + ": read error");
  return digest.finish();
}

}  // namespace taxelsim
