// Content hashes: results are keyed by the content they came from.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace underbody::core {

/// 32 hexadecimal digits of XXH3-128: for keys, not for secrets.
std::string content_hash(std::string_view bytes);
std::string content_hash_of_file(const std::filesystem::path& path);

/// Hash of several parts, each with its length, so that ("ab","c") and ("a","bc") differ.
class Hasher {
public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;
    Hasher& add(std::string_view part);
    Hasher& add(double value);
    [[nodiscard]] std::string digest() const;

private:
    void* state_;
};

}  // namespace underbody::core
