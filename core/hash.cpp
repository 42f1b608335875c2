#include "core/hash.h"

#include <xxhash.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <new>

#include "core/file.h"

namespace underbody::core {

namespace {
std::string hexadecimal(XXH128_hash_t hash) {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    static constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const unsigned char byte : canonical.digest) {
        text += digits[byte >> 4U];
        text += digits[byte & 15U];
    }
    return text;
}
}  // namespace

std::string content_hash(std::string_view bytes) { return hexadecimal(XXH3_128bits(bytes.data(), bytes.size())); }

std::string content_hash_of_file(const std::filesystem::path& path) { return content_hash(MappedFile(path).bytes()); }

Hasher::Hasher() : state_(XXH3_createState()) {
    if (state_ == nullptr) {
        throw std::bad_alloc();
    }
    XXH3_128bits_reset(static_cast<XXH3_state_t*>(state_));
}

Hasher::~Hasher() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

Hasher& Hasher::add(std::string_view part) {
    const std::uint64_t length = part.size();
    XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), &length, sizeof length);
    XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), part.data(), part.size());
    return *this;
}

Hasher& Hasher::add(double value) {
    std::array<char, sizeof value> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    return add(std::string_view(bytes.data(), bytes.size()));
}

std::string Hasher::digest() const { return hexadecimal(XXH3_128bits_digest(static_cast<XXH3_state_t*>(state_))); }

}  // namespace underbody::core
