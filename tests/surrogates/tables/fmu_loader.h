// A small importer of FMI 2.0: an FMU out of its zip, and the functions that a simulator calls.
#pragma once

#include <dlfcn.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

namespace underbody::test {

/// Entries of a zip of stored files.
inline std::map<std::string, std::string> unzipped(const std::string& zip) {
    std::map<std::string, std::string> entries;
    const auto number = [&](std::size_t at, int bytes) {
        std::size_t v = 0;
        for (int i = bytes; i-- > 0;) {
            v = v << 8 | static_cast<unsigned char>(zip[at + i]);
        }
        return v;
    };
    for (std::size_t at = 0; number(at, 4) == 0x04034b50;) {
        const std::size_t size = number(at + 18, 4), name = number(at + 26, 2);
        entries[zip.substr(at + 30, name)] = zip.substr(at + 30 + name, size);
        at += 30 + name + size;
    }
    return entries;
}

enum Status { ok, warning, discard, error };

/// The functions of FMI 2.0 that a simulator calls.
class Fmu {
public:
    explicit Fmu(const std::filesystem::path& library) : library_(::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL)) {}
    ~Fmu() {
        if (library_ != nullptr) {
            ::dlclose(library_);
        }
    }
    Fmu(const Fmu&) = delete;
    Fmu& operator=(const Fmu&) = delete;

    [[nodiscard]] bool loaded() const { return library_ != nullptr; }
    void* instantiate(int type, const std::string& guid) {
        return function<void* (*)(const char*, int, const char*, const char*, const void*, int, int)>(
            "fmi2Instantiate")("x", type, guid.c_str(), "", nullptr, 0, 0);
    }
    template <class... Arguments>
    int call(const char* name, Arguments... arguments) {
        return function<int (*)(Arguments...)>(name)(arguments...);
    }
    void free(void* instance) { function<void (*)(void*)>("fmi2FreeInstance")(instance); }

private:
    template <class Function>
    Function function(const char* name) {
        void* found = ::dlsym(library_, name);
        if (found == nullptr) {
            throw std::runtime_error(std::string("the FMU lacks ") + name);
        }
        return reinterpret_cast<Function>(found);
    }
    void* library_;
};

}  // namespace underbody::test
