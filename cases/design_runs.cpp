// Runs of a design search: each planned design at each condition and fidelity, as cases of a sweep, and their loads.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/design_file.h"
#include "cases/sweep.h"
#include "cases/sweep_parts.h"
#include "core/error.h"
#include "geometry/body/exact_body.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/settled.h"
#include "postproc/loads/stated_loads.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::SearchVariable;

namespace {

/// Equal but for the rounding of a file.
bool same_point(const std::vector<SearchVariable>& variables, const std::vector<double>& a,
                const std::vector<double>& b) {
    for (std::size_t v = 0; v < variables.size(); ++v) {
        if (std::abs(a[v] - b[v]) > 1e-7 * (variables[v].upper - variables[v].lower)) {
            return false;
        }
    }
    return true;
}

/// The centre of buoyancy of the placed body, in the axes of its case.
geometry::Vec3 centre_of_buoyancy(const SweepCase& one) {
    const geometry::VolumeMoments m = geometry::ExactBody(geometry::read_shape(one.shape)).moments();
    geometry::Placement placement;
    placement.gap = one.conditions.number("gap").value_or(0);
    placement.pitch = one.conditions.number("pitch").value_or(0);
    return geometry::placed(geometry::Vec3{m.x / m.one, 0, m.z / m.one}, placement);
}

/// The loads of a solved case, SI, with what they scatter by.
void take_loads(const Study& study, const SweepCase& one, DesignRun& run, core::Progress& progress) {
    postproc::ReadOptions reading;
    reading.surfaces_only = true;
    const fs::path file = one.folder / solved_marker;
    const postproc::Field field = postproc::read_field(file, reading, progress);
    postproc::LoadsOptions options;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.reference = study.moments_about;
    options.references.density = study.reference.number("density");
    const postproc::LoadsResult result = postproc::loads(field, options, progress);
    core::Problems notes;
    const postproc::Settled settled = postproc::settled_by(result, postproc::stated_beside(file, result), file, notes);
    for (const auto& column : postproc::table_columns(result)) {
        run.loads[column.name] = column.value;
    }
    for (const auto& load : settled.loads) {
        run.sigmas[load.quantity] = load.sigma;
    }
    const geometry::Vec3 centre = centre_of_buoyancy(one);
    const double ahead = result.reference[0] - centre.x, above = result.reference[2] - centre.z;
    const auto of = [](const std::map<std::string, double>& values, const char* name) {
        const auto found = values.find(name);
        return found == values.end() ? 0.0 : found->second;
    };
    run.loads[moment_at_buoyancy] =
        of(run.loads, "pitch_moment") + ahead * of(run.loads, "lift_force") + above * of(run.loads, "drag_force");
    run.sigmas[moment_at_buoyancy] = std::hypot(of(run.sigmas, "pitch_moment"), ahead * of(run.sigmas, "lift_force"),
                                                above * of(run.sigmas, "drag_force"));
    // The solver's run has its own, narrower criterion: of each iteration, not of the trend alone.
    const auto marker = read_marker(file);
    const bool stopped_early = marker.is_object() && marker.contains("settled") && marker["settled"] == false;
    run.state =
        stopped_early || settled.verdict == postproc::SettledVerdict::not_settled ? not_settled_state : "solved";
}

/// What a fidelity's planned designs come to as a sweep.
SweepSpec sweep_of(const DesignSpec& spec, const FidelitySpec& fidelity, const std::vector<PlannedDesign>& plan,
                   const Study& study) {
    SweepSpec sweep;
    sweep.folder = fs::relative(spec.folder / "runs" / fidelity.name, study.folder()).string();
    for (const PlannedDesign& design : plan) {
        if (design.fidelity == fidelity.name && design.state == "planned") {
            sweep.bodies.push_back({design.name, spec.folder / "shapes" / (design.name + ".toml")});
        }
    }
    sweep.gaps = spec.gaps;
    sweep.pitches = spec.pitches;
    sweep.speeds = spec.speeds;
    sweep.mesh = fidelity.mesh;
    return sweep;
}

}  // namespace

void Design::solve(const Study& study, int jobs, core::Progress& progress) {
    const std::vector<SearchVariable> all = spec_.all_variables();
    for (const FidelitySpec& fidelity : spec_.fidelities) {
        Study with_sweep = study;
        with_sweep.sweep = sweep_of(spec_, fidelity, plan_, study);
        if (with_sweep.sweep->bodies.empty()) {
            continue;
        }
        const auto empty_run = [&](const SweepCase& one) {
            const std::string variant = one.shape.stem().string();
            const auto planned =
                std::find_if(plan_.begin(), plan_.end(), [&](const PlannedDesign& d) { return d.name == variant; });
            DesignRun run{variant, planned->at, fidelity.name, {}, {}, ""};
            for (std::size_t v = spec_.variables.size(); v < all.size(); ++v) {
                run.at.push_back(one.conditions.number(all[v].name).value_or(0));
            }
            return run;
        };
        const auto known = [&](const DesignRun& run) {
            return std::find_if(runs_.begin(), runs_.end(), [&](const DesignRun& r) {
                return r.design == run.design && r.fidelity == run.fidelity && same_point(all, r.at, run.at);
            });
        };
        const auto keep = [&](const SweepCase& one, const std::string& failure) {
            DesignRun run = empty_run(one);
            run.state = one_field(failure);
            if (failure.empty()) {
                try {
                    take_loads(study, one, run, progress);
                } catch (const core::Cancelled&) {
                    throw;
                } catch (const core::Error& error) {
                    run.state = one_field(error.message());
                }
            }
            const auto same = known(run);
            if (same != runs_.end() && same->loads.empty() && run.loads.empty() && same->state == run.state) {
                return;  // failed again in the same way
            }
            if (same != runs_.end()) {
                *same = run;
            } else {
                runs_.push_back(run);
            }
            write();  // what was computed stays when the next case is interrupted
        };
        for (const SweepCase& one : sweep_cases(with_sweep, progress)) {
            const auto there = known(empty_run(one));
            if (one.present && (there == runs_.end() || !there->usable())) {
                keep(one, "");
            }
        }
        SweepOptions options;
        options.jobs = jobs;
        // A row without its case is of another solver, or of a search that was handed on without its fields.
        options.wanted = [&](const SweepCase& one) {
            const auto there = known(empty_run(one));
            return there == runs_.end() || !there->usable() || fs::exists(one.folder);
        };
        options.ended = keep;
        (void)sweep_locally(with_sweep, options, progress);
    }
}

}  // namespace underbody::cases
