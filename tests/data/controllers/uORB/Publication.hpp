#pragma once
struct orb_metadata;
namespace uORB {
template <class Topic>
class Publication {
public:
    explicit Publication(const orb_metadata* meta);
    bool publish(const Topic& data);
};
}  // namespace uORB
