#pragma once
#include <memory>
namespace nav_msgs::msg {
struct Odometry {
    using SharedPtr = std::shared_ptr<Odometry>;
    struct {
        struct {
            struct {
                double x = 0, y = 0, z = 0;
            } linear, angular;
        } twist;
    } twist;
};
}  // namespace nav_msgs::msg
