#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/thesis/parts.h"
#include "core/text.h"

namespace underbody::thesis {

std::vector<double> Motion::total() const { return difference(ground, drag); }

Motion motion_of(const SeparatedPlant& plant, double gap, double velocity, double duration, double step,
                 const std::vector<double>& input) {
    Motion m;
    const auto n = static_cast<std::size_t>(std::round(duration / step));
    double h = gap, w = velocity;
    for (std::size_t k = 0; k <= n; ++k) {
        const double u = k < input.size() ? input[k] : 0;
        double ground_slope = 0;
        DragSlopes drag_slopes;
        m.time.push_back(step * static_cast<double>(k));
        m.gap.push_back(h);
        m.velocity.push_back(w);
        m.ground.push_back(plant.ground_force(h, ground_slope));
        m.drag.push_back(plant.drag_force(h, w, drag_slopes));
        m.acceleration.push_back(plant.acceleration(h, w, u));
        m.ground_rate.push_back(ground_slope * w);
        m.drag_rate.push_back(drag_slopes.velocity * m.acceleration.back() + drag_slopes.gap * w);
        m.input.push_back(u);
        plant.advance(h, w, u, step);
    }
    return m;
}

core::Figure plot(const std::string& title, const std::string& caption, const std::string& x, const std::string& x_unit,
                  const std::string& y, const std::string& y_unit) {
    core::Figure f;
    f.title = title;
    f.caption = caption;
    f.x.label = x;
    f.x.unit = x_unit;
    f.y.label = y;
    f.y.unit = y_unit;
    return f;
}

void curve(core::Figure& figure, const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
           std::size_t colour, bool dashed, double y_scale) {
    core::FigureCurve c;
    c.name = name;
    c.x = x;
    c.y = y;
    for (double& v : c.y) {
        v *= y_scale;
    }
    c.colour =
        colour == 7 ? core::Colour{25, 25, 25, 255} : core::palette(colour);  // 7: the truth, black as in the thesis
    c.dashed = dashed;
    figure.curves.push_back(std::move(c));
}

void points(core::Figure& figure, const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
            std::size_t colour, core::FigurePoints::Shape shape, double size) {
    core::FigurePoints p;
    p.name = name;
    p.x = x;
    p.y = y;
    p.colour = core::palette(colour);
    p.shape = shape;
    p.size = size;
    figure.points.push_back(std::move(p));
}

std::string number(double value, int digits) { return core::format_number(value, digits); }

std::string numbers(const std::vector<double>& values, int digits) {
    std::string text;
    double largest = 0;
    for (const double v : values) {
        largest = std::max(largest, std::abs(v));
    }
    for (const double v : values) {  // what is round-off beside the others is zero
        text += (text.empty() ? "" : ", ") + number(std::abs(v) < 1e-13 * largest ? 0 : v, digits);
    }
    return text;
}

TrainingSet grid_samples(const SeparatedPlant& plant, double gap_lower, double gap_upper, std::size_t count) {
    TrainingOptions o;
    o.gap_lower = gap_lower;
    o.gap_upper = gap_upper;
    o.samples = count;
    return training_set(plant, o);
}

TrainingSet time_samples(const SeparatedPlant& plant, double gap_lower, double gap_upper, std::size_t count) {
    TrainingOptions o;
    o.method = TrainingOptions::Method::time;
    o.gap_lower = gap_lower;
    o.gap_upper = gap_upper;
    o.samples = count;
    o.start_at_rest = true;
    return training_set(plant, o);
}

AugmentedModel p3_of_8_47() {
    return corrected(published_8_47(), Correction::p3, heave_rows(Layout::heave(), thesis_virtual_mass(), 0));
}

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) {
        sum += v * v;
    }
    return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> d(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        d[i] = a[i] - b[i];
    }
    return d;
}

Study separation(core::Progress& progress) {
    Study study;
    progress.report(0, "chapter 7");
    add_chapter_7(study, progress);
    add_peers(study, progress);
    progress.report(0.5, "chapter 8");
    add_chapter_8(study, progress);
    return study;
}

}  // namespace underbody::thesis
