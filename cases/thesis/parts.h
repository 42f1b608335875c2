// Shared by the parts of chapters 7 and 8.
#pragma once

#include <string>
#include <vector>

#include "cases/thesis/claims.h"
#include "cases/thesis/published.h"

namespace underbody::thesis {

using namespace estimator;

/// The parts of the study; each adds its figures and claims.
void add_chapter_7(Study& study, core::Progress& progress);
/// Tangent, equivalent-linear, learned, dmdc, edmd and nonlinear models side by side.
void add_peers(Study& study, core::Progress& progress);
void add_chapter_8(Study& study, core::Progress& progress);
void add_control(Study& study, core::Progress& progress);  ///< the end of chapter 8

/// Unforced (or forced) motion of the plant, sampled.
struct Motion {
    std::vector<double> time, gap, velocity, ground, drag, ground_rate, drag_rate, acceleration, input;
    [[nodiscard]] std::vector<double> total() const;
};
Motion motion_of(const SeparatedPlant& plant, double gap, double velocity, double duration, double step,
                 const std::vector<double>& input = {});

core::Figure plot(const std::string& title, const std::string& caption, const std::string& x, const std::string& x_unit,
                  const std::string& y, const std::string& y_unit);
void curve(core::Figure& figure, const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
           std::size_t colour, bool dashed = false, double y_scale = 1);
void points(core::Figure& figure, const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
            std::size_t colour, core::FigurePoints::Shape shape = core::FigurePoints::Shape::disc, double size = 7);

std::string number(double value, int digits = 4);
std::string numbers(const std::vector<double>& values, int digits = 4);

TrainingSet grid_samples(const SeparatedPlant& plant, double gap_lower = 0, double gap_upper = 1.2,
                         std::size_t count = 50000);
TrainingSet time_samples(const SeparatedPlant& plant, double gap_lower = 0, double gap_upper = 1.0,
                         std::size_t count = 50000);

AugmentedModel p3_of_8_47();  ///< 8.47 with correction P3

double rms(const std::vector<double>& values);
std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace underbody::thesis
