// What effects add to the pitch of a body that moves in heave and pitch: plain numbers, evaluated in heave_pitch.cpp.
#pragma once

#include <cmath>

namespace underbody::dynamics {

/// M = moment - (linear + quadratic |q|) q - stiffness sin(pitch) + input_arm cos(pitch) input, about the centre of
/// gravity, nose up. Springs at points of the base pull with -k (h + a sin(pitch) - g) each, a metres ahead of the
/// base's centre; kept as sums over them.
struct PitchTerms {
    double moment = 0;        ///< N m
    double linear = 0;        ///< N m s
    double quadratic = 0;     ///< N m s^2
    double stiffness = 0;     ///< N m
    double inertia = 0;       ///< kg m^2, beside the declared
    double input_arm = 0;     ///< m, ahead of the centre of gravity, at which the input acts
    double moment_gain = 1;   ///< of the recorded input_moment
    double mass_forward = 0;  ///< m, centre of gravity ahead of the declared one
    double spring = 0, spring_arm = 0, spring_arm_square = 0;  ///< sums of k, k a, k a^2
    double spring_rest = 0, spring_rest_arm = 0;               ///< sums of k g, k a g
    double sensor_bias = 0;                                    ///< rad: reading = pitch + bias

    void add_spring(double k, double gap, double ahead) {
        spring += k;
        spring_arm += k * ahead;
        spring_arm_square += k * ahead * ahead;
        spring_rest += k * gap;
        spring_rest_arm += k * ahead * gap;
    }
    /// Force up beyond that of the springs at the base's centre (which the heave channel holds), and moment nose up of
    /// all their force; `reach`: base's centre ahead of the centre of gravity, along the ground.
    void add_loads(double h, double pitch, double q, double input, double reach, double& up, double& turn) const {
        const double s = std::sin(pitch), c = std::cos(pitch);
        up -= spring_arm * s;
        turn += moment - (linear + quadratic * std::abs(q)) * q - stiffness * s + input_arm * c * input -
                reach * (spring * h + spring_arm * s - spring_rest) -
                c * (spring_arm * h + spring_arm_square * s - spring_rest_arm);
    }
};

}  // namespace underbody::dynamics
