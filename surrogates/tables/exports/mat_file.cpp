#include "surrogates/tables/exports/mat_file.h"

#include <matio.h>

#include "core/error.h"

namespace underbody::tables {

MatFile::MatFile(const std::filesystem::path& path)
    : file_(Mat_CreateVer(path.c_str(), "MATLAB 5.0 MAT-file, force table by Underbody", MAT_FT_MAT5)) {
    if (file_ == nullptr) {
        throw core::SystemError("write", "the file cannot be written", {path.string(), {}, {}, {}});
    }
}

MatFile::~MatFile() { Mat_Close(file_); }

void MatFile::write(matvar_t* variable) {
    const int failed = variable == nullptr ? 1 : Mat_VarWrite(file_, variable, MAT_COMPRESSION_NONE);
    Mat_VarFree(variable);
    if (failed != 0) {
        throw core::SystemError("write", "a variable of the .mat file cannot be written");
    }
}

void MatFile::reals(const std::string& name, const std::vector<double>& values, std::size_t rows, std::size_t columns) {
    std::size_t sizes[2] = {rows, columns};
    write(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes, const_cast<double*>(values.data()), 0));
}

void MatFile::grid(const std::string& name, const std::vector<double>& values, const std::vector<std::size_t>& sizes) {
    if (sizes.size() == 1) {
        reals(name, values, sizes[0], 1);
        return;
    }
    std::vector<double> turned(values.size());
    for (std::size_t node = 0; node < values.size(); ++node) {
        std::size_t rest = node, at = 0;
        std::vector<std::size_t> index(sizes.size());
        for (std::size_t k = sizes.size(); k-- > 0;) {
            index[k] = rest % sizes[k];
            rest /= sizes[k];
        }
        for (std::size_t k = sizes.size(); k-- > 0;) {
            at = at * sizes[k] + index[k];
        }
        turned[at] = values[node];
    }
    std::vector<std::size_t> dimensions = sizes;
    write(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(sizes.size()), dimensions.data(),
                        turned.data(), 0));
}

void MatFile::text(const std::string& name, const std::string& value) {
    std::size_t sizes[2] = {1, value.size()};
    write(Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, sizes, const_cast<char*>(value.data()), 0));
}

}  // namespace underbody::tables
