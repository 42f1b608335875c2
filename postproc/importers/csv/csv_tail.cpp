#include "postproc/importers/csv/csv_tail.h"

#include <vtkPolyData.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/text.h"
#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

namespace {

/// Edges that one face alone has, of all faces but the last.
class Rim {
public:
    explicit Rim(const SurfaceArrays& surface) {
        const auto offsets = surface.offsets();
        const auto nodes = surface.connectivity();
        std::unordered_map<std::uint64_t, int> seen;
        for (std::size_t f = 0; f + 2 < offsets.size(); ++f) {
            for (Index i = offsets[f]; i < offsets[f + 1]; ++i) {
                const Index a = nodes[static_cast<std::size_t>(i)];
                const Index b = nodes[static_cast<std::size_t>(i + 1 < offsets[f + 1] ? i + 1 : offsets[f])];
                ++seen[(static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint64_t>(std::max(a, b))];
            }
        }
        for (const auto& [edge, faces] : seen) {
            if (faces == 1) {
                const auto a = static_cast<Index>(edge >> 32);
                const auto b = static_cast<Index>(edge & 0xffffffffU);
                beside_[a].push_back(b);
                beside_[b].push_back(a);
            }
        }
    }
    [[nodiscard]] const std::vector<Index>& beside(Index node) const {
        static const std::vector<Index> none;
        const auto found = beside_.find(node);
        return found == beside_.end() ? none : found->second;
    }
    /// Over one node of the rim, or two, from one to the other; the first of them begins with these digits.
    [[nodiscard]] bool leads(Index from, Index to, std::string_view digits) const {
        const auto next_to = [&](Index node, Index other) {
            const auto& all = beside(node);
            return std::find(all.begin(), all.end(), other) != all.end();
        };
        for (const Index first : beside(from)) {
            if (first == to || !std::to_string(first).starts_with(digits) || std::to_string(first) == digits) {
                continue;
            }
            const auto& seconds = beside(first);
            if (next_to(first, to) || std::any_of(seconds.begin(), seconds.end(), [&](Index second) {
                    return second != from && next_to(second, to);
                })) {
                return true;
            }
        }
        return false;
    }

private:
    std::unordered_map<Index, std::vector<Index>> beside_;
};

/// The numbers of a row; `open`: the digits at its end, where another could follow.
std::vector<Index> corners_in(std::string_view row, std::string_view& open) {
    std::vector<Index> corners;
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    for (std::size_t i = 0; i < row.size();) {
        std::size_t end = i;
        while (end < row.size() && is_digit(row[end])) {
            ++end;
        }
        if (end > i) {
            if (const auto number = core::parse_integer(row.substr(i, end - i))) {
                corners.push_back(*number);
            }
            open = end == row.size() ? row.substr(i, end - i) : std::string_view();
        }
        i = std::max(end, i + 1);
    }
    return corners;
}

}  // namespace

bool last_face_is_cut(vtkPolyData& surface, std::string_view row) {
    std::string_view open;
    const std::vector<Index> corners = corners_in(row, open);
    const SurfaceArrays arrays(surface);
    if (corners.size() < 3 || arrays.faces() < 2) {
        return false;
    }
    const Rim rim(arrays);
    const auto shared = [&](Index a, Index b) {
        const auto& all = rim.beside(a);
        return std::find(all.begin(), all.end(), b) != all.end();
    };
    if (shared(corners.back(), corners.front())) {
        return false;  // it closes where a neighbour is
    }
    // Corners that are missing behind the last one, or the last one with more digits.
    return rim.leads(corners.back(), corners.front(), "") ||
           (!open.empty() && rim.leads(corners[corners.size() - 2], corners.front(), open));
}

}  // namespace underbody::postproc
