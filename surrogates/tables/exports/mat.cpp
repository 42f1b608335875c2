// MATLAB and Octave: a .mat (level 5, by matio) and a .m that looks it up.
#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"
#include "surrogates/tables/exports/mat_file.h"

namespace underbody::tables {

namespace {

/// Variables of the first quantity have no ending, those of the others _2, _3, ...
std::string ending(std::size_t quantity) { return quantity == 0 ? "" : "_" + std::to_string(quantity + 1); }

/// The cell of each point, and the weights of its corners along each axis.
constexpr const char* find_cells =
    "n = double(t.axes);\n"
    "rows = size(point, 1); quantities = double(t.quantities);\n"
    "slope = zeros(rows, n, quantities); sigma = zeros(rows, quantities); value = zeros(rows, quantities);\n"
    "over = zeros(rows, n); outside = false(rows, 1);\n"
    "c = zeros(rows, n); u = zeros(rows, n); w = cell(n, 1); d = cell(n, 1); refused = false(rows, 1);\n"
    "for k = 1:n\n"
    "    x = t.(sprintf('x%d', k - 1)); x = x(:); v = point(:, k);\n"
    "    p = min(max(v, x(1)), x(end)); p(isnan(v)) = NaN;\n"
    "    over(:, k) = v - p;\n"
    "    off = v < t.lower(k) | v > t.upper(k) | isnan(v); outside = outside | off; refused = refused | (off & "
    "t.outside(k) == 1);\n"
    "    % cell of each point: how many of the lower cell ends sort before it (sort is stable)\n"
    "    ends = numel(x) - 1; [~, order] = sort([x(1:ends); p]); is_end = order <= ends; count = cumsum(is_end);\n"
    "    i = zeros(rows, 1); i(order(~is_end) - ends) = count(~is_end); c(:, k) = i;\n"
    "    h = reshape(x(i + 1) - x(i), rows, 1); s = (p - reshape(x(i), rows, 1)) ./ h; q = 1 - s; u(:, k) = s;\n"
    "    w{k} = [q .* q .* (1 + 2 * s), h .* s .* q .* q, s .* s .* (3 - 2 * s), -h .* s .* s .* q];\n"
    "    d{k} = [-6 * s .* q ./ h, q .* (1 - 3 * s), 6 * s .* q ./ h, s .* (3 * s - 2)];\n"
    "    if t.outside(k) == 2, w{k} = w{k} + repmat(over(:, k), 1, 4) .* d{k}; end  % on along the tangent\n"
    "    for m = 1:quantities\n"
    "        ending = ''; if m > 1, ending = sprintf('_%d', m); end\n"
    "        cells = t.([sprintf('cell_error%d', k - 1) ending]); growth = t.(['growth' ending]);\n"
    "        if ~isempty(cells), sigma(:, m) = sigma(:, m) + reshape(cells(i), rows, 1) * 4 .* s .* q; end\n"
    "        sigma(:, m) = sigma(:, m) + abs(over(:, k)) .* reshape(growth(k, 1 + (over(:, k) > 0)), rows, 1);\n"
    "    end\n"
    "end\n";

/// Value, slopes and error out of the corners of the cells.
constexpr const char* sum_corners =
    "held = over ~= 0;\n"
    "for corner = 0:2^n - 1\n"
    "    node = zeros(rows, 1); weight = ones(rows, 1);\n"
    "    for k = 1:n\n"
    "        b = bitand(floor(corner / 2^(k - 1)), 1);\n"
    "        node = node * numel(t.(sprintf('x%d', k - 1))) + c(:, k) - 1 + b;\n"
    "        weight = weight .* (b * u(:, k) + (1 - b) * (1 - u(:, k)));\n"
    "    end\n"
    "    for mask = 0:2^n - 1\n"
    "        one = ones(rows, 1); part = ones(rows, n);\n"
    "        for k = 1:n\n"
    "            i = 1 + 2 * bitand(floor(corner / 2^(k - 1)), 1) + bitand(floor(mask / 2^(k - 1)), 1);\n"
    "            one = one .* w{k}(:, i);\n"
    "            for j = 1:n\n"
    "                if j == k, part(:, j) = part(:, j) .* d{k}(:, i); else, part(:, j) = part(:, j) .* w{k}(:, "
    "i); end\n"
    "            end\n"
    "        end\n"
    "        for m = 1:quantities\n"
    "            ending = ''; if m > 1, ending = sprintf('_%d', m); end\n"
    "            if mask == 0, sigma(:, m) = sigma(:, m) + weight .* reshape(t.(['sigma' ending])(node + 1), rows, "
    "1); end\n"
    "            data = reshape(t.(['hermite' ending])(mask + 1, node + 1), rows, 1);\n"
    "            value(:, m) = value(:, m) + data .* one; slope(:, :, m) = slope(:, :, m) + repmat(data, 1, n) .* "
    "part;\n"
    "        end\n"
    "    end\n"
    "end\n";

/// What the policies make of points outside, and where there is no data.
constexpr const char* outside_and_empty =
    "policy = repmat(reshape(t.outside, 1, n), rows, 1);\n"
    "for m = 1:quantities\n"
    "    s = slope(:, :, m); s(held & policy == 0) = 0; s(refused, :) = NaN; slope(:, :, m) = s;\n"
    "end\n"
    "value(refused, :) = NaN;\n"
    "no_data = outside;\n"
    "if t.support\n"
    "    at = zeros(rows, 1);\n"
    "    for k = 1:n\n"
    "        x = t.(sprintf('known%d', k - 1)); x = x(:); cells = numel(x) - 1; i = zeros(rows, 1);\n"
    "        for line = 2:cells, i = i + (point(:, k) >= x(line)); end\n"
    "        at = at * cells + i;\n"
    "    end\n"
    "    no_data = no_data | reshape(t.has_data(at + 1), rows, 1) == 0;\n"
    "end\n"
    "end\n";

/// What MATLAB shows as help.
std::string help_text(const ExportGrid& grid, const std::string& name, const std::string& mat) {
    std::string text = "function [value, slope, sigma, outside, no_data] = " + name + "(point, file)\n";
    for (const auto& line : header_lines(grid)) {
        text += "% " + line + "\n";
    }
    text += "%\n% point: one row a point, one column an axis";
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        text += (k == 0 ? ": " : ", ") + grid.axes[k].name + " [" + grid.axes[k].unit + "]";
    }
    if (grid.quantities.size() > 1) {
        text += "\n% value, sigma: one column a quantity, slope: rows x axes x quantities;";
        for (const auto& q : grid.quantities) {
            text += " " + q.name + " [" + q.unit + "]" + (&q == &grid.quantities.back() ? "" : ",");
        }
    }
    text += "\n% file: another .mat file, for this call only (default: " + mat + " beside this function)\n";
    return text;
}

std::string lookup(const ExportGrid& grid, const std::string& name, const std::string& mat) {
    return help_text(grid, name, mat) +
           "persistent own;\n"
           "if nargin > 1\n"
           "    t = load(file);\n"
           "else\n"
           "    if isempty(own)\n"
           "        own = load(fullfile(fileparts(mfilename('fullpath')), '" +
           mat +
           "'));\n"
           "    end\n"
           "    t = own;\n"
           "end\n" +
           find_cells + sum_corners + outside_and_empty;
}

void write_axes(const ExportGrid& grid, MatFile& file) {
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        const std::string id = std::to_string(k);
        const ExportAxis& axis = grid.axes[k];
        file.text("axis" + id, axis.name + " [" + axis.unit + "]");
        file.reals("x" + id, axis.points, axis.points.size(), 1);
        if (!grid.support.empty()) {
            file.reals("known" + id, grid.support.lines()[k], grid.support.lines()[k].size(), 1);
        }
    }
}

/// What counts as inside, and where there is data.
void write_ends(const ExportGrid& grid, MatFile& file) {
    const std::size_t n = grid.axes.size();
    std::vector<double> outside, lower, upper;
    for (const ExportAxis& axis : grid.axes) {
        outside.push_back(axis.range == RangePolicy::clamp ? 0 : axis.range == RangePolicy::refuse ? 1 : 2);
        lower.push_back(axis.lower);
        upper.push_back(axis.upper);
    }
    file.reals("outside", outside, n, 1);  // 0 holds its ends, 1 refuses, 2 goes on along its tangent
    file.reals("lower", lower, n, 1);
    file.reals("upper", upper, n, 1);
    // Cells between the lines known0, known1 ..., last axis fastest: 1 where there are points around.
    file.reals("support", {grid.support.empty() ? 0.0 : 1.0}, 1, 1);
    if (!grid.support.empty()) {
        file.reals("has_data", {grid.support.has_data().begin(), grid.support.has_data().end()},
                   grid.support.has_data().size(), 1);
    }
}

void write_quantities(const ExportGrid& grid, MatFile& file) {
    const std::size_t n = grid.axes.size(), width = std::size_t{1} << n;
    for (std::size_t q = 0; q < grid.quantities.size(); ++q) {
        const ExportQuantity& quantity = grid.quantities[q];
        if (q > 0) {
            file.text("quantity" + ending(q), quantity.name);
            file.text("unit" + ending(q), quantity.unit);
        }
        std::vector<double> growth(2 * n);
        for (std::size_t k = 0; k < n; ++k) {
            const auto& cells = quantity.error.cell_error(k);
            file.reals("cell_error" + std::to_string(k) + ending(q), cells, cells.size(), cells.empty() ? 0 : 1);
            growth[k] = quantity.error.growth(k)[0];
            growth[n + k] = quantity.error.growth(k)[1];
        }
        // MATLAB stores columns: one column a grid node.
        file.reals("hermite" + ending(q), quantity.surface.hermite(), width, quantity.surface.nodes());
        file.reals("sigma" + ending(q), quantity.error.node_sigma(), quantity.error.node_sigma().size(), 1);
        file.reals("growth" + ending(q), growth, n, 2);
        file.reals("max_error" + ending(q), {quantity.difference}, 1, 1);
    }
}

}  // namespace

std::filesystem::path mat_function(const std::filesystem::path& path) {
    return path.parent_path() / (identifier(path.stem().string()) + "_at.m");
}

void export_mat(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result) {
    core::PendingFile pending(path);
    {
        MatFile file(pending.path());
        std::string origin;
        for (const auto& line : header_lines(grid)) {
            origin += line + "\n";
        }
        file.text("origin", origin);
        file.text("quantity", grid.first().name);
        file.text("unit", grid.first().unit);
        file.reals("axes", {static_cast<double>(grid.axes.size())}, 1, 1);
        file.reals("quantities", {static_cast<double>(grid.quantities.size())}, 1, 1);
        write_axes(grid, file);
        write_quantities(grid, file);
        write_ends(grid, file);
    }
    pending.commit();
    const std::filesystem::path m = mat_function(path);
    core::write_file(m, lookup(grid, m.stem().string(), path.filename().string()));
    result.files.push_back(m);
}

}  // namespace underbody::tables
