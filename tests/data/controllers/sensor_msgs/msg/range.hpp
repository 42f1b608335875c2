#pragma once
#include <memory>
namespace sensor_msgs::msg {
struct Range {
    using SharedPtr = std::shared_ptr<Range>;
    float range = 0;
};
}  // namespace sensor_msgs::msg
