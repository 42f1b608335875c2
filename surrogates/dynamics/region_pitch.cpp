// Where motions of heave and pitch end.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/dormand_prince.h"
#include "surrogates/dynamics/heave_pitch.h"
#include "surrogates/dynamics/heave_pitch_contact.h"
#include "surrogates/dynamics/region_parts.h"

namespace underbody::dynamics {

namespace {

/// A neighbourhood x'Px < level of a linearly stable equilibrium that no motion leaves, checked at points of its
/// shells.
struct Capture {
    std::size_t class_index = 0;
    double gap = 0, pitch = 0;
    bool holds = false;
    Dense p;
    double level = 0;
    [[nodiscard]] double value(const PitchState& y) const {
        const double x[4] = {y[0] - gap, y[1], y[2] - pitch, y[3]};
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                sum += x[i] * p(i, j) * x[j];
            }
        }
        return sum;
    }
};

class PitchEnds {
public:
    PitchEnds(const HeavePitch& plant, const RegionOptions& options, double escape, const PitchState& sizes)
        : plant_(plant), options_(options), escape_(escape), sizes_(sizes), equilibria_(plant.equilibria()) {
        for (const HeaveEquilibrium& e : equilibria_) {
            if (e.stable) {
                add_attractor(e);
            }
        }
        attractors_ = classes_.size();
        classes_.push_back({"contact", EndKind::contact});
        classes_.push_back({"escape", EndKind::escape});
        for (std::size_t i = 0; i < attractors_; ++i) {
            classes_.push_back({"about " + classes_[i].name, EndKind::cycle, classes_[i].gap, 0});
        }
        classes_.push_back({"undecided", EndKind::undecided});
    }

    [[nodiscard]] const std::vector<EndClass>& classes() const { return classes_; }
    [[nodiscard]] const std::vector<HeaveEquilibrium>& equilibria() const { return equilibria_; }
    [[nodiscard]] End of(const PitchState& start) const;

private:
    enum { contact_offset = 0, escape_offset = 1 };
    [[nodiscard]] int contact_class() const { return static_cast<int>(attractors_); }
    [[nodiscard]] int escape_class() const { return static_cast<int>(attractors_) + 1; }
    [[nodiscard]] int undecided_class() const { return static_cast<int>(classes_.size()) - 1; }

    void add_attractor(const HeaveEquilibrium& e);
    [[nodiscard]] int captured(const PitchState& y) const {
        for (const Capture& capture : captures_) {
            if (capture.holds && capture.value(y) < capture.level) {
                return static_cast<int>(capture.class_index);
            }
        }
        return -1;
    }

    struct Rate {
        const HeavePitch* plant;
        ContactState bearing;
        void operator()(double, const double* y, double* d) const {
            PitchState rate;
            plant->rate({y[0], y[1], y[2], y[3]}, bearing, rate);
            std::copy(rate.begin(), rate.end(), d);
        }
    };

    /// Swing about an attractor in units of the sizes, over a part of the time.
    struct Extent {
        PitchState low{1e300, 1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300, -1e300};
        void take(const PitchState& y) {
            for (std::size_t i = 0; i < 4; ++i) {
                low[i] = std::min(low[i], y[i]);
                high[i] = std::max(high[i], y[i]);
            }
        }
    };
    [[nodiscard]] End settled(const Extent& third, const Extent& fourth) const;
    [[nodiscard]] bool rests(const PitchState& y, ContactState bearing) const;

    const HeavePitch& plant_;
    const RegionOptions& options_;
    double escape_;
    PitchState sizes_;
    std::vector<HeaveEquilibrium> equilibria_;
    std::vector<EndClass> classes_;
    std::vector<Capture> captures_;
    std::size_t attractors_ = 0;
};

void PitchEnds::add_attractor(const HeaveEquilibrium& e) {
    Capture capture;
    capture.class_index = classes_.size();
    capture.gap = e.gap;
    capture.pitch = e.pitch;
    classes_.push_back({e.name, EndKind::attractor, e.gap, 0});
    const LinearSystem system = plant_.linearised(e.gap, e.pitch);
    double worst = -1e300;
    for (const Eigen1& mode : eigen(system.a)) {
        worst = std::max(worst, mode.value.real());
    }
    if (worst < -1e-4) {
        Dense weights(4, 4);
        for (std::size_t i = 0; i < 4; ++i) {
            weights(i, i) = 1 / (sizes_[i] * sizes_[i]);
        }
        capture.p = lyapunov(system.a, weights);
        // Directions on the unit sphere of P; the level grows until the value rises somewhere on its shell.
        core::Random random(11);
        std::vector<PitchState> directions;
        for (int k = 0; k < 1500; ++k) {
            PitchState d{};
            for (std::size_t i = 0; i < 4; ++i) {
                d[i] = random.normal() * sizes_[i];
            }
            PitchState at{capture.gap + d[0], d[1], capture.pitch + d[2], d[3]};
            const double norm = std::sqrt(capture.value(at));
            for (double& part : d) {
                part /= norm;
            }
            directions.push_back(d);
        }
        const auto falls = [&](double radius) {
            return std::all_of(directions.begin(), directions.end(), [&](const PitchState& d) {
                const PitchState y{capture.gap + radius * d[0], radius * d[1], capture.pitch + radius * d[2],
                                   radius * d[3]};
                const std::array<double, 2> gaps = plant_.edge_gaps(y);
                if (std::min(gaps[0], gaps[1]) <= 0 || y[0] >= escape_) {
                    return false;
                }
                PitchState rate{};
                plant_.rate(y, ContactState::free, rate);
                const double x[4] = {y[0] - capture.gap, y[1], y[2] - capture.pitch, y[3]};
                double growth = 0;
                for (std::size_t i = 0; i < 4; ++i) {
                    for (std::size_t j = 0; j < 4; ++j) {
                        growth += 2 * x[i] * capture.p(i, j) * rate[j];
                    }
                }
                return growth < 0;
            });
        };
        double radius = 1e-6;
        while (radius < 1e6 && falls(radius)) {
            radius *= 1.15;
        }
        radius /= 1.15 * 1.3;  // a margin, since shells are checked at points only
        capture.holds = radius > 2e-6;
        capture.level = radius * radius;
    }
    captures_.push_back(std::move(capture));
}

bool PitchEnds::rests(const PitchState& y, ContactState bearing) const {
    if (bearing != ContactState::flat || std::abs(y[1]) > 1e-6 || std::abs(y[3]) > 1e-6) {
        return false;
    }
    const std::array<double, 2> normal = plant_.normal_forces(y, bearing);
    return normal[0] > 0 && normal[1] > 0;
}

End PitchEnds::settled(const Extent& third, const Extent& fourth) const {
    double nearest = 1e300;
    std::size_t at = attractors_;
    double before = 0, after = 0;
    for (std::size_t k = 0; k < captures_.size(); ++k) {
        const double centre[4] = {captures_[k].gap, 0, captures_[k].pitch, 0};
        double far3 = 0, far4 = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            far3 = std::max(
                far3, std::max(std::abs(third.low[i] - centre[i]), std::abs(third.high[i] - centre[i])) / sizes_[i]);
            far4 = std::max(
                far4, std::max(std::abs(fourth.low[i] - centre[i]), std::abs(fourth.high[i] - centre[i])) / sizes_[i]);
        }
        if (far4 < nearest) {
            nearest = far4;
            at = k;
            before = far3;
            after = far4;
        }
    }
    if (at < attractors_ && after < 0.5) {
        if (after < 2e-3 || after < 0.97 * before) {
            return {static_cast<int>(at), options_.duration};
        }
        if (after < 1.03 * before) {
            return {static_cast<int>(attractors_ + 2 + at), options_.duration};
        }
    }
    return {undecided_class(), options_.duration};
}

End PitchEnds::of(const PitchState& start) const {
    PitchState y = start;
    const std::array<double, 2> gaps = plant_.edge_gaps(y);
    if (std::min(gaps[0], gaps[1]) <= 0 && !options_.through_contact) {
        return {contact_class(), 0};
    }
    if (std::min(gaps[0], gaps[1]) < 0) {
        return {contact_class(), 0};  // a start inside the ground
    }
    if (y[0] >= escape_) {
        return {escape_class(), 0};
    }
    ContactState bearing = ContactState::free;
    PitchState scale;
    for (std::size_t i = 0; i < 4; ++i) {
        scale[i] = options_.tolerance * 10 * sizes_[i];
    }
    double t = 0;
    Extent third, fourth;
    int changes = 0;
    while (t < options_.duration) {
        const Rate rate{&plant_, bearing};
        DormandPrince<4, Rate> ode(rate, t, y, scale, 0.02);
        bool changed = false;
        while (!changed && t < options_.duration) {
            if (!ode.step(options_.duration) || ode.tries() > 400000) {
                return {undecided_class(), ode.t()};
            }
            t = ode.t();
            y = ode.y();
            // The earliest event within the step: a gap that closes or a bearing force that vanishes.
            const auto values = [&](const PitchState& s) {
                const std::array<double, 2> gap = plant_.edge_gaps(s);
                std::array<double, 2> value = gap;
                if (bearing != ContactState::free) {
                    const std::array<double, 2> normal = plant_.normal_forces(s, bearing);
                    for (std::size_t e = 0; e < 2; ++e) {
                        value[e] = (static_cast<int>(bearing) >> e & 1) ? normal[e] : gap[e];
                    }
                }
                return std::min(value[0], value[1]);
            };
            const auto between = [&](double part) {
                return PitchState{ode.between(part, 0), ode.between(part, 1), ode.between(part, 2),
                                  ode.between(part, 3)};
            };
            double hit = -1;
            for (const double part : {0.25, 0.5, 0.75, 1.0}) {
                if (values(part == 1.0 ? y : between(part)) < 0) {
                    hit = part;
                    break;
                }
            }
            if (hit > 0) {
                double lo = hit - 0.25, hi = hit;
                for (int i = 0; i < 40; ++i) {
                    const double middle = (lo + hi) / 2;
                    (values(between(middle)) < 0 ? hi : lo) = middle;
                }
                t = ode.before_t() + hi * (ode.t() - ode.before_t());
                if (!options_.through_contact) {
                    return {contact_class(), t};
                }
                y = between(hi);
                try {
                    land(plant_, y, bearing);
                } catch (const core::Error&) {
                    return {undecided_class(), t};
                }
                if (rests(y, bearing)) {
                    return {contact_class(), t};
                }
                if (++changes > 2000) {
                    return {std::abs(y[1]) < 1e-3 * sizes_[1] ? contact_class() : undecided_class(), t};
                }
                changed = true;
            }
            if (y[0] >= escape_) {
                return {escape_class(), t};
            }
            if (bearing == ContactState::free) {
                const int index = captured(y);
                if (index >= 0) {
                    return {index, t};
                }
            } else if (rests(y, bearing)) {
                return {contact_class(), t};
            }
            if (t > 0.5 * options_.duration) {
                (t > 0.75 * options_.duration ? fourth : third).take(y);
            }
        }
    }
    return bearing == ContactState::free ? settled(third, fourth) : End{contact_class(), options_.duration};
}

std::size_t state_of(const std::string& axis) {
    return axis == "gap" ? 0 : axis == "heave_velocity" ? 1 : axis == "pitch" ? 2 : 3;
}

void add_flow(const HeavePitch& plant, const RegionOptions& o, const PitchState& middle, StabilityRegion& region) {
    const std::size_t first = state_of(o.axes[0].name), second = state_of(o.axes[1].name);
    constexpr int across = 22, up = 14;
    for (int j = 0; j < up; ++j) {
        for (int i = 0; i < across; ++i) {
            PitchState y = middle, d{};
            y[first] = o.axes[0].lower + (o.axes[0].upper - o.axes[0].lower) * (i + 0.5) / across;
            y[second] = o.axes[1].lower + (o.axes[1].upper - o.axes[1].lower) * (j + 0.5) / up;
            const std::array<double, 2> gaps = plant.edge_gaps(y);
            if (std::min(gaps[0], gaps[1]) < 0) {
                continue;
            }
            plant.rate(y, ContactState::free, d);
            region.flow_x.push_back(y[first]);
            region.flow_y.push_back(y[second]);
            region.flow_dx.push_back(d[first]);
            region.flow_dy.push_back(d[second]);
        }
    }
}

}  // namespace

StabilityRegion pitch_region(const Model& model, const RegionOptions& options, core::Progress& progress) {
    const HeavePitch plant(model, options.held);
    const std::size_t first = state_of(options.axes[0].name), second = state_of(options.axes[1].name);
    StabilityRegion region;
    region.contact_gap = plant.contact_gap();
    region.table_lower = plant.table_lower();
    region.table_upper = plant.table_upper();
    const double top = plant.table_upper() < 1e299 ? plant.table_upper() : 1.0;
    PitchState middle{options.held.get(Channel::gap, 0.5 * top), options.held.get(Channel::heave_velocity, 0),
                      options.held.get(Channel::pitch, 0), options.held.get(Channel::pitch_rate, 0)};
    PitchState sizes{top - plant.contact_gap(), 0.1, 0.2, 0.2};
    double highest = middle[0];
    for (const core::NamedRange& axis : options.axes) {
        sizes[state_of(axis.name)] = axis.upper - axis.lower;
        highest = axis.name == "gap" ? axis.upper : highest;
    }
    region.escape_gap = std::isnan(options.escape_gap) ? std::max(top, highest) : options.escape_gap;
    if (first != 0 && second != 0 && !options.held.has(Channel::gap)) {
        throw core::InputError("missing", "the region holds the gap, but nothing says at what", {},
                               "give it: --conditions gap=20mm");
    }
    const PitchEnds ends(plant, options, region.escape_gap, sizes);
    progress.report(0.02, "finding where starts end");
    const RegionBatch batch = [&](std::span<const double> x, std::span<const double> y, std::span<End> out) {
        core::parallel_blocks(
            x.size(), 16,
            [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    PitchState state = middle;
                    state[first] = x[i];
                    state[second] = y[i];
                    out[i] = ends.of(state);
                }
            },
            progress);
    };
    const std::vector<End> found = region_grid(options, batch);
    const std::vector<double> sums = region_fractions(options, batch, found, ends.classes().size());
    region.axes = options.axes;
    region.columns = options.columns;
    region.rows = options.rows;
    region.duration = options.duration;
    region.equilibria = ends.equilibria();
    region.model = model.name;
    region.held = options.held.over(model.conditions);
    region.rule =
        std::string(
            "heave and pitch coupled: a start belongs to an attractor once inside a level set of a Lyapunov function "
            "that falls on every "
            "shell (checked at 1500 points each), or when its swing over the last quarter of the time shrinks; ") +
        (options.through_contact ? "impacts are gone through, contact is to come to rest on the ground"
                                 : "contact is the first touch of an edge");
    for (const End& end : found) {
        region.index.push_back(end.index);
        region.time.push_back(static_cast<float>(end.time));
    }
    keep_seen_classes(region, ends.classes(), sums);
    if (first == 0 || second == 0) {
        const core::NamedRange& gaps = first == 0 ? options.axes[0] : options.axes[1];
        const double inside =
            std::max(0.0, std::min(gaps.upper, region.table_upper) - std::max(gaps.lower, region.table_lower));
        region.outside_fraction =
            region.table_upper < 1e299 ? std::max(0.0, 1 - inside / (gaps.upper - gaps.lower)) : 0.0;
    }
    add_cell_boundaries(region);
    add_flow(plant, options, middle, region);
    region.remarks = model.remarks;
    for (const EffectUse& use : model.effects) {
        if (use.name != "declared_parameter") {
            region.remarks.push_back({core::Problem::Severity::warning,
                                      "effect " + use.name + " acts in heave alone and is left out of this region",
                                      {}});
        }
    }
    return region;
}

}  // namespace underbody::dynamics
