// A .mat file (level 5) that is written, by matio. For the files of this folder only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct _mat_t;
struct matvar_t;

namespace underbody::tables {

/// Throws core::SystemError when it cannot be written.
class MatFile {
public:
    explicit MatFile(const std::filesystem::path& path);
    ~MatFile();
    MatFile(const MatFile&) = delete;
    MatFile& operator=(const MatFile&) = delete;

    /// Columns one after the other.
    void reals(const std::string& name, const std::vector<double>& values, std::size_t rows, std::size_t columns);
    /// Over the nodes of a grid of these sizes, last axis fastest; in the file its first axis is the first dimension.
    void grid(const std::string& name, const std::vector<double>& values, const std::vector<std::size_t>& sizes);
    void text(const std::string& name, const std::string& value);

private:
    void write(matvar_t* variable);
    _mat_t* file_;
};

}  // namespace underbody::tables
