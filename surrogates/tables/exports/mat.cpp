// MATLAB and Octave: a .mat (level 5, by matio) and a .m that looks it up.
#include <matio.h>

#include <cstring>
#include <memory>

#include "core/error.h"
#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

class MatFile {
public:
    explicit MatFile(const std::filesystem::path& path)
        : file_(Mat_CreateVer(path.c_str(), "MATLAB 5.0 MAT-file, force table by Underbody", MAT_FT_MAT5)) {
        if (file_ == nullptr) {
            throw core::SystemError("write", "the file cannot be written", {path.string(), {}, {}, {}});
        }
    }
    ~MatFile() { Mat_Close(file_); }
    MatFile(const MatFile&) = delete;
    MatFile& operator=(const MatFile&) = delete;

    void reals(const std::string& name, const std::vector<double>& values, std::size_t rows, std::size_t columns) {
        std::size_t sizes[2] = {rows, columns};
        write(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes, const_cast<double*>(values.data()), 0));
    }
    void text(const std::string& name, const std::string& value) {
        std::size_t sizes[2] = {1, value.size()};
        write(Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, sizes, const_cast<char*>(value.data()), 0));
    }

private:
    void write(matvar_t* variable) {
        const int failed = variable == nullptr ? 1 : Mat_VarWrite(file_, variable, MAT_COMPRESSION_NONE);
        Mat_VarFree(variable);
        if (failed != 0) {
            throw core::SystemError("write", "a variable of the .mat file cannot be written");
        }
    }
    mat_t* file_;
};

std::string lookup(const ExportGrid& grid, const std::string& name, const std::string& mat) {
    std::string text = "function [value, slope, sigma, outside] = " + name + "(point, file)\n";
    for (const auto& line : header_lines(grid)) {
        text += "% " + line + "\n";
    }
    text += "%\n% point: one row a point, one column an axis";
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        text += (k == 0 ? ": " : ", ") + grid.axes[k].name + " [" + grid.axes[k].unit + "]";
    }
    text += "\n% file: the .mat file (default: " + mat + " beside this function)\n";
    text +=
        "persistent t;\n"
        "if nargin > 1\n"
        "    t = load(file);\n"
        "elseif isempty(t)\n"
        "    t = load(fullfile(fileparts(mfilename('fullpath')), '" + mat + "'));\n"
        "end\n"
        "n = double(t.axes);\n"
        "rows = size(point, 1);\n"
        "slope = zeros(rows, n); sigma = zeros(rows, 1); beyond = zeros(rows, n);\n"
        "value = zeros(rows, 1); c = zeros(rows, n); u = zeros(rows, n); w = cell(n, 1); d = cell(n, 1);\n"
        "for k = 1:n\n"
        "    x = t.(sprintf('x%d', k - 1)); x = x(:); v = point(:, k);\n"
        "    p = min(max(v, x(1)), x(end)); p(isnan(v)) = NaN;\n"
        "    beyond(:, k) = v - p;\n"
        "    % cell of each point: how many of the lower cell ends sort before it (sort is stable)\n"
        "    ends = numel(x) - 1; [~, order] = sort([x(1:ends); p]); is_end = order <= ends; count = cumsum(is_end);\n"
        "    i = zeros(rows, 1); i(order(~is_end) - ends) = count(~is_end); c(:, k) = i;\n"
        "    h = reshape(x(i + 1) - x(i), rows, 1); s = (p - reshape(x(i), rows, 1)) ./ h; q = 1 - s; u(:, k) = s;\n"
        "    w{k} = [q .* q .* (1 + 2 * s), h .* s .* q .* q, s .* s .* (3 - 2 * s), -h .* s .* s .* q];\n"
        "    d{k} = [-6 * s .* q ./ h, q .* (1 - 3 * s), 6 * s .* q ./ h, s .* (3 * s - 2)];\n"
        "    if t.outside(k) == 2, w{k} = w{k} + repmat(beyond(:, k), 1, 4) .* d{k}; end  % on along the tangent\n"
        "    cells = t.(sprintf('cell_error%d', k - 1));\n"
        "    if ~isempty(cells), sigma = sigma + reshape(cells(i), rows, 1) * 4 .* s .* q; end\n"
        "    sigma = sigma + abs(beyond(:, k)) .* reshape(t.growth(k, 1 + (beyond(:, k) > 0)), rows, 1);\n"
        "end\n"
        "held = beyond ~= 0; outside = any(held, 2);\n"
        "for corner = 0:2^n - 1\n"
        "    node = zeros(rows, 1); weight = ones(rows, 1);\n"
        "    for k = 1:n\n"
        "        b = bitand(floor(corner / 2^(k - 1)), 1);\n"
        "        node = node * numel(t.(sprintf('x%d', k - 1))) + c(:, k) - 1 + b;\n"
        "        weight = weight .* (b * u(:, k) + (1 - b) * (1 - u(:, k)));\n"
        "    end\n"
        "    sigma = sigma + weight .* reshape(t.sigma(node + 1), rows, 1);\n"
        "    for mask = 0:2^n - 1\n"
        "        product = reshape(t.hermite(mask + 1, node + 1), rows, 1); part = repmat(product, 1, n);\n"
        "        for k = 1:n\n"
        "            i = 1 + 2 * bitand(floor(corner / 2^(k - 1)), 1) + bitand(floor(mask / 2^(k - 1)), 1);\n"
        "            product = product .* w{k}(:, i);\n"
        "            for j = 1:n\n"
        "                if j == k, part(:, j) = part(:, j) .* d{k}(:, i); else, part(:, j) = part(:, j) .* w{k}(:, i); end\n"
        "            end\n"
        "        end\n"
        "        value = value + product; slope = slope + part;\n"
        "    end\n"
        "end\n"
        "policy = repmat(reshape(t.outside, 1, n), rows, 1);\n"
        "slope(held & policy == 0) = 0;\n"
        "refused = any(held & policy == 1, 2); value(refused) = NaN; slope(refused, :) = NaN;\n"
        "end\n";
    return text;
}

}  // namespace

std::filesystem::path mat_function(const std::filesystem::path& path) {
    return path.parent_path() / (identifier(path.stem().string()) + "_at.m");
}

void export_mat(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    const std::size_t width = std::size_t{1} << grid.axes.size();
    core::PendingFile pending(path);
    {
        MatFile file(pending.path());
        std::string origin;
        for (const auto& line : header_lines(grid)) {
            origin += line + "\n";
        }
        file.text("origin", origin);
        file.text("quantity", grid.quantity);
        file.text("unit", grid.unit);
        file.reals("axes", {static_cast<double>(grid.axes.size())}, 1, 1);
        std::vector<double> growth(2 * grid.axes.size()), outside(grid.axes.size());
        for (std::size_t k = 0; k < grid.axes.size(); ++k) {
            const std::string id = std::to_string(k);
            file.text("axis" + id, grid.axes[k].name + " [" + grid.axes[k].unit + "]");
            file.reals("x" + id, grid.axes[k].points, grid.axes[k].points.size(), 1);
            const auto& cells = grid.error.cell_error(k);
            file.reals("cell_error" + id, cells, cells.size(), cells.empty() ? 0 : 1);
            outside[k] = grid.axes[k].range == RangePolicy::clamp ? 0 : grid.axes[k].range == RangePolicy::refuse ? 1 : 2;
            growth[k] = grid.error.growth(k)[0];
            growth[grid.axes.size() + k] = grid.error.growth(k)[1];
        }
        // MATLAB stores columns: one column a grid node.
        file.reals("hermite", grid.surface.hermite(), width, grid.surface.nodes());
        file.reals("sigma", grid.error.node_sigma(), grid.error.node_sigma().size(), 1);
        file.reals("growth", growth, grid.axes.size(), 2);
        file.reals("outside", outside, grid.axes.size(), 1);  // 0 holds its ends, 1 refuses, 2 goes on along its tangent
    }
    pending.commit();
    const std::filesystem::path m = mat_function(path);
    core::write_file(m, lookup(grid, m.stem().string(), path.filename().string()));
    result.files.push_back(m);
}

}  // namespace underbody::tables
