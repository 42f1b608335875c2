#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>
namespace geometry_msgs::msg {
struct WrenchStamped {
    using SharedPtr = std::shared_ptr<WrenchStamped>;
    struct {
        rclcpp::Time stamp;
        std::string frame_id;
    } header;
    struct {
        struct {
            double x = 0, y = 0, z = 0;
        } force, torque;
    } wrench;
};
}  // namespace geometry_msgs::msg
