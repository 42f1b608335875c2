// A plot as a value: what is drawn, without a drawing library. Rooms return figures; `studio/figures` draws them,
// the same on screen, in reports and in files.
#pragma once

#include <string>
#include <vector>

namespace underbody::core {

struct Colour {
    unsigned char red = 0;
    unsigned char green = 0;
    unsigned char blue = 0;
    unsigned char alpha = 255;
    friend bool operator==(const Colour&, const Colour&) = default;
};

/// Colours told apart by people with any colour vision (Okabe and Ito 2008), by index, repeating.
Colour palette(std::size_t index);

struct FigureAxis {
    std::string label;  ///< "gap"
    std::string unit;   ///< unit of the numbers in the figure: "mm" (the maker of the figure converts)
    double lower = 0;   ///< lower == upper: fit to the data
    double upper = 0;
    bool logarithmic = false;
    friend bool operator==(const FigureAxis&, const FigureAxis&) = default;
};

struct FigureCurve {
    std::string name;  ///< legend; empty: not in the legend
    std::vector<double> x;
    std::vector<double> y;
    Colour colour;
    double width = 2;
    bool dashed = false;
    bool steps = false;
    friend bool operator==(const FigureCurve&, const FigureCurve&) = default;
};

struct FigureBand {
    std::string name;
    std::vector<double> x;
    std::vector<double> lower;
    std::vector<double> upper;
    Colour colour{0, 114, 178, 50};
    friend bool operator==(const FigureBand&, const FigureBand&) = default;
};

struct FigurePoints {
    enum class Shape { disc, circle, square, triangle, cross, plus, diamond };
    std::string name;
    std::vector<double> x;
    std::vector<double> y;
    std::vector<double> y_error;  ///< one standard deviation; may be empty
    Colour colour;
    Shape shape = Shape::disc;
    double size = 7;
    friend bool operator==(const FigurePoints&, const FigurePoints&) = default;
};

/// A straight line across the whole plot.
struct FigureLine {
    bool vertical = false;
    double at = 0;
    std::string label;
    Colour colour{120, 120, 120, 255};
    bool dashed = true;
    friend bool operator==(const FigureLine&, const FigureLine&) = default;
};

struct FigureNote {
    double x = 0;
    double y = 0;
    std::string text;
    friend bool operator==(const FigureNote&, const FigureNote&) = default;
};

/// A grid of classes over the axes' box (a stability map). `index[j * columns + i]`: i along x, j along y,
/// cell-centred.
struct FigureClasses {
    std::size_t columns = 0;
    std::size_t rows = 0;
    double x_lower = 0, x_upper = 0, y_lower = 0, y_upper = 0;
    std::vector<int> index;
    std::vector<std::string> names;
    std::vector<Colour> colours;
    friend bool operator==(const FigureClasses&, const FigureClasses&) = default;
};

/// A grid of values, drawn with a colour scale; NaN is left blank.
struct FigureMap {
    std::size_t columns = 0;
    std::size_t rows = 0;
    double x_lower = 0, x_upper = 0, y_lower = 0, y_upper = 0;
    std::vector<double> values;
    std::string label;
    std::string unit;
    bool diverging = false;       ///< centred on zero
    double lower = 0, upper = 0;  ///< colour range; equal: from the data
    bool x_by_ratio = false;      ///< cells along x are of equal ratio, not of equal width; x_lower > 0
    bool y_by_ratio = false;
    friend bool operator==(const FigureMap&, const FigureMap&) = default;
};

/// Arrows of a flow (dx/dt, dy/dt): drawn with one length, direction in axis coordinates.
struct FigureArrows {
    std::vector<double> x, y, dx, dy;
    Colour colour{90, 90, 90, 160};
    friend bool operator==(const FigureArrows&, const FigureArrows&) = default;
};

struct FigureBars {
    std::string name;
    std::vector<std::string> labels;
    std::vector<double> values;
    std::vector<double> errors;
    Colour colour{0, 114, 178, 255};
    friend bool operator==(const FigureBars&, const FigureBars&) = default;
};

/// Equal in every number and word; one that holds a NaN is equal to none.
struct Figure {
    std::string title;
    std::string caption;  ///< printed under it in a report: what it shows and from what it was made
    FigureAxis x;
    FigureAxis y;
    std::vector<FigureClasses> classes;
    std::vector<FigureMap> maps;
    std::vector<FigureBand> bands;
    std::vector<FigureCurve> curves;
    std::vector<FigurePoints> points;
    std::vector<FigureLine> lines;
    std::vector<FigureArrows> arrows;
    std::vector<FigureBars> bars;
    std::vector<FigureNote> notes;
    bool equal_scales = false;
    bool legend = true;
    friend bool operator==(const Figure&, const Figure&) = default;
};

}  // namespace underbody::core
