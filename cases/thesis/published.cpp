#include "cases/thesis/published.h"

#include "surrogates/tables/fit/force_table.h"

namespace underbody::thesis {

using namespace estimator;

double thesis_virtual_mass() { return 1 / 0.2529; }

namespace {

const std::vector<double>& knots_gap() {
    static const std::vector<double> h{-.05, -.04, -.03, -.02, -.01, 0,   .01, .02, .03, .04, .05, .06, .07,
                                       .08,  .09,  .10,  .12,  .14,  .16, .18, .20, .25, .30, .35, .40, .45,
                                       .50,  .60,  .70,  .80,  .90,  1.0, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8};
    return h;
}

const std::vector<double>& knots_force() {
    static const std::vector<double> f{.040,   .0284,  .0188,   .011,   .0049,  0,      -.0041, -.0074, -.010, -.012,
                                       -.0134, -.0142, -.01445, -.0142, -.0134, -.0122, -.0087, -.0044, 0,     .0039,
                                       .0073,  .0134,  .017,    .0189,  .01975, .020,   .0198,  .0184,  .016,  .0131,
                                       .0102,  .0076,  .0055,   .0039,  .0027,  .0019,  .0009,  .0004};
    return f;
}

AugmentedModel given(const Matrix& a, const Vector& b) {
    return AugmentedModel::from_matrices(Layout::heave(), a, Matrix::column(b));
}

}  // namespace

std::function<double(double, double&)> reference_ground_force() {
    static const tables::ForceTable table = [] {  // fitted once: a fit judges its points by leaving them out
        core::Table points;
        points.source = "REF-A";
        points.add_numbers("gap", "m", knots_gap());
        points.add_numbers("lift_force", "N", knots_force());
        tables::FitOptions options;
        options.kind = tables::FitOptions::Kind::spline;
        return tables::ForceTable::fit(points, "lift_force", options);
    }();
    return [](double gap, double& slope) { return table.value(&gap, &slope); };
}

SeparatedPlant reference_plant(ResistanceLaw drag) {
    SeparatedPlant plant;
    plant.virtual_mass = thesis_virtual_mass();
    plant.ground_force = reference_ground_force();
    plant.drag_force = std::move(drag);
    plant.lower = knots_gap().front();
    plant.upper = knots_gap().back();
    return plant;
}

AugmentedModel published_8_47() {
    return given(Matrix{{-0.004919, -0.007430, 0.252801, -0.252492},
                        {0.999996, -0.002997, 0.000005, -0.000302},
                        {-0.000086, -0.00002, 0.000050, -0.001507},
                        {0.833822, 0.000023, 0.3769891, -1.340565}},
                 {0.252803, 0.000031, -0.000050, 0.378132});
}

AugmentedModel published_grid() {
    return given(Matrix{{0, 0, 0.2529, -0.2529},
                        {1, 0, 0.0003, -0.0003},
                        {0.0411, -0.0013, -0.0236, 0.0275},
                        {0.8737, 0.0001, 0.3760, -1.3748}},
                 {0.2528, 0.0003, -0.0042, 0.3778});
}

AugmentedModel published_7_48() {
    return given(Matrix{{-0.1556, 0, 0.2490, -0.1245},
                        {0.4922, 0, 0, 0.3938},
                        {0.0005, 0, -0.0008, 0.0004},
                        {-0.1945, 0, 0.3112, -0.1556}},
                 {0.2492, 0, 0.0200, 0});
}

Matrix printed_covariance() {
    return Matrix{{1.0000, -0.0007, 0.0018, -0.0000, -0.0007, 0.3888, 0.0067, -0.0013, 0.3888},
                  {-0.0007, 1.0000, -0.0000, -0.0000, 1.0000, -0.8436, 0.9999, 0.0018, -0.8436},
                  {0.0018, -0.0000, 1.0000, 0.3361, -0.0000, 0.1253, 0.0024, -0.0167, 0.1253},
                  {-0.0000, -0.0000, 0.3361, 1.0000, 0.0000, 0.3709, 0.0070, -0.0151, 0.3709},
                  {-0.0007, 1.0000, -0.0000, 0.0000, 1.0000, -0.8436, 0.9999, 0.0018, -0.8436},
                  {0.3888, -0.8436, 0.1253, 0.3709, -0.8436, 1.0000, -0.8381, -0.0032, 1.0000},
                  {-0.0007, 1.0000, -0.0000, -0.0000, 1.0000, -0.8436, 0.9999, 0.0018, -0.8436},
                  {-0.0013, 0.0018, -0.0167, -0.0151, 0.0018, -0.0032, 0.0018, 1.0000, -0.0032},
                  {0.3888, -0.8436, 0.1253, 0.3709, -0.8436, 1.0000, -0.8381, -0.0032, 1.0000}};
}

Matrix printed_basis() {
    return Matrix{{-0.0928, 0.2940, -0.8408, 0.0523, -0.2191}, {0.4428, 0.2048, -0.1209, -0.0005, 0.0637},
                  {-0.0383, 0.5427, 0.3855, -0.0409, -0.7444}, {-0.0918, 0.6517, 0.2442, -0.0483, 0.6087},
                  {0.4428, 0.2048, -0.1209, -0.0005, 0.0637},  {-0.4435, 0.1830, -0.1342, -0.0016, 0.0870},
                  {0.4428, 0.2048, -0.1209, -0.0005, 0.0637},  {0.0020, -0.0393, -0.0712, -0.9966, -0.0109},
                  {-0.4435, 0.1830, -0.1342, -0.0016, 0.0870}};
}

Vector printed_eigenvalues() { return {4.6901, 1.4913, 1.1239, 0.9986, 0.6960, 0, 0, 0, 0}; }

}  // namespace underbody::thesis
