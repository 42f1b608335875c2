// Node values of the shipped CFD against the solver's own forces.
#include <gmock/gmock.h>

#include <cmath>

#include "core/table.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

TEST(LoadsOfEvie, AgreeWithTheSolverForEveryShippedField) {
    UNDERBODY_NEEDS_SHARED("cfd/forces.csv");
    const auto folder = test::shared_folder() / "cfd";
    const core::Table forces = core::read_csv(folder / "forces.csv");
    double worst_lift = 0;
    double worst_drag = 0;
    double worst_moment = 0;
    for (std::size_t row = 0; row < forces.rows(); ++row) {
        const Field field = read_field(folder / forces.text("file")[row]);
        LoadsOptions options;
        options.symmetry = "y";
        const LoadsResult result = loads(field, options);
        const double drag = forces.numbers("drag_force")[row];
        const double lift = forces.numbers("lift_force")[row];
        // The file's forces are means over the last iterations, the field is the last one.
        const double settled = 0.01 * std::hypot(drag, lift) + 3 * forces.numbers("lift_force_scatter")[row];
        const double size = std::hypot(drag, lift);
        SCOPED_TRACE(forces.text("file")[row]);
        EXPECT_NEAR(result.named.drag_force, drag, settled);
        EXPECT_NEAR(result.named.lift_force, lift, settled);
        EXPECT_NEAR(result.named_viscous.drag_force, forces.numbers("drag_viscous")[row], 0.003 * size);
        EXPECT_NEAR(result.named_pressure.lift_force, forces.numbers("lift_pressure")[row], settled);
        const double base_at_middle =
            result.reference[2] - result.reference[0] * std::tan(forces.numbers("pitch")[row]);
        EXPECT_NEAR(base_at_middle, forces.numbers("gap")[row], 1e-6);
        // The solver's moments are about the centre of the ellipsoid's base, also where a variant has less of it.
        const double moment = result.named.pitch_moment + result.reference[0] * result.named.lift_force;
        EXPECT_NEAR(moment, forces.numbers("pitch_moment")[row], settled * 0.0727);
        EXPECT_LT(result.closure, 1e-5);
        EXPECT_EQ(result.values_from, "nodes");
        EXPECT_EQ(result.named.side_force, 0);
        EXPECT_EQ(result.named.roll_moment, 0);
        for (const auto& problem : result.problems) {
            ADD_FAILURE() << problem.message;
        }
        worst_lift = std::max(worst_lift, std::abs(result.named.lift_force - lift) / size);
        worst_drag = std::max(worst_drag, std::abs(result.named.drag_force - drag) / size);
        worst_moment = std::max(worst_moment, std::abs(moment - forces.numbers("pitch_moment")[row]) / (size * 0.0727));
    }
    RecordProperty("worst_lift", std::to_string(worst_lift));
    std::cout << "of the force: lift " << worst_lift << ", drag " << worst_drag << "; moment, of force times length "
              << worst_moment << "\n";
}

}  // namespace
}  // namespace underbody::postproc
