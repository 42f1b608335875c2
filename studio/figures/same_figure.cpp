#include "studio/figures/same_figure.h"

#include <algorithm>
#include <tuple>

namespace underbody::studio {

namespace {

auto parts(const core::Colour& v) { return std::tie(v.red, v.green, v.blue, v.alpha); }
auto parts(const core::FigureAxis& v) { return std::tie(v.label, v.unit, v.lower, v.upper, v.logarithmic); }
auto parts(const core::FigureCurve& v) { return std::tie(v.name, v.x, v.y, v.width, v.dashed, v.steps); }
auto parts(const core::FigureBand& v) { return std::tie(v.name, v.x, v.lower, v.upper); }
auto parts(const core::FigurePoints& v) { return std::tie(v.name, v.x, v.y, v.y_error, v.shape, v.size); }
auto parts(const core::FigureLine& v) { return std::tie(v.vertical, v.at, v.label, v.dashed); }
auto parts(const core::FigureNote& v) { return std::tie(v.x, v.y, v.text); }
auto parts(const core::FigureClasses& v) {
    return std::tie(v.columns, v.rows, v.x_lower, v.x_upper, v.y_lower, v.y_upper, v.index, v.names);
}
auto parts(const core::FigureMap& v) {
    return std::tie(v.columns, v.rows, v.x_lower, v.x_upper, v.y_lower, v.y_upper, v.values, v.label, v.unit,
                    v.diverging, v.lower, v.upper, v.x_by_ratio, v.y_by_ratio);
}
auto parts(const core::FigureArrows& v) { return std::tie(v.x, v.y, v.dx, v.dy); }
auto parts(const core::FigureBars& v) { return std::tie(v.name, v.labels, v.values, v.errors); }

template <class T>
bool same(const T& a, const T& b) {
    if constexpr (requires { a.colour; }) {
        if (parts(a.colour) != parts(b.colour)) {
            return false;
        }
    }
    return parts(a) == parts(b);
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const T& x, const T& y) { return same(x, y); });
}

}  // namespace

bool same_figure(const core::Figure& a, const core::Figure& b) {
    const auto classes = [](const core::FigureClasses& x, const core::FigureClasses& y) {
        return same(x, y) && same(x.colours, y.colours);
    };
    return std::tie(a.title, a.caption, a.equal_scales, a.legend) ==
               std::tie(b.title, b.caption, b.equal_scales, b.legend) &&
           same(a.x, b.x) && same(a.y, b.y) && same(a.maps, b.maps) && same(a.bands, b.bands) &&
           same(a.curves, b.curves) && same(a.points, b.points) && same(a.lines, b.lines) && same(a.arrows, b.arrows) &&
           same(a.bars, b.bars) && same(a.notes, b.notes) &&
           std::equal(a.classes.begin(), a.classes.end(), b.classes.begin(), b.classes.end(), classes);
}

}  // namespace underbody::studio
