// A traction control as a ROS 2 node in C++, in the place of ours: answers torque_request with torque_command.
//
//     scripts/run.sh shchur2019 --node "asr=ros2 run cpp_node own_asr"
//
// One answer to each request, with the stamp of the request: that is all that lockstep asks of a node. The stack repeats
// messages where it waits for somebody; a request that was answered gets the same answer again.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "ramp_limit.hpp"
#include "rclcpp/rclcpp.hpp"
#include "sensor_msgs/msg/joint_state.hpp"

using sensor_msgs::msg::JointState;

class OwnAsr : public rclcpp::Node {
public:
    OwnAsr()
    : Node("asr"),  // the name of the role: nobody else is heard on its topics
      period_(declare_parameter("control_period", 0.01)),
      law_{declare_parameter("limit", 1000.0), declare_parameter("rate", 2000.0)} {
        const auto quality = rclcpp::QoS(rclcpp::KeepLast(256)).reliable();
        publisher_ = create_publisher<JointState>("torque_command", quality);
        subscription_ = create_subscription<JointState>(
            "torque_request", quality, std::bind(&OwnAsr::answer, this, std::placeholders::_1));
    }

private:
    void answer(const JointState &request) {
        const rclcpp::Time stamp(request.header.stamp);
        const bool is_first = stamp.nanoseconds() < 100'000;  // of a run: each reset adds 10 ns to all stamps
        if (is_first && last_stamp_ >= 0 && stamp.nanoseconds() != last_stamp_) {  // a reset: the run begins anew
            last_.fill(0.0);
            last_stamp_ = -1;
        }
        if (stamp.nanoseconds() > last_stamp_) {
            last_stamp_ = stamp.nanoseconds();
            command_ = request;  // with its stamp, its frame and its brake torques
            std::array<double, 4> asked{};
            for (std::size_t wheel = 0; wheel < asked.size(); ++wheel) {
                asked[wheel] = request.effort[place(request, wheel)];
            }
            law_.step(period_, asked, last_);
            for (std::size_t wheel = 0; wheel < last_.size(); ++wheel) {
                command_.effort[place(request, wheel)] = last_[wheel];
            }
        }
        publisher_->publish(command_);
    }

    static std::size_t place(const JointState &message, std::size_t wheel) {
        static const std::array<std::string, 4> names{"front_left", "front_right", "rear_left", "rear_right"};
        const auto found = std::find(message.name.begin(), message.name.end(), names[wheel]);
        if (found == message.name.end() || message.effort.size() != message.name.size()) {
            throw std::runtime_error("torque_request lacks " + names[wheel]);
        }
        return static_cast<std::size_t>(found - message.name.begin());
    }

    double period_;
    RampLimit law_;
    std::array<double, 4> last_{};
    std::int64_t last_stamp_ = -1;
    JointState command_;
    rclcpp::Publisher<JointState>::SharedPtr publisher_;
    rclcpp::Subscription<JointState>::SharedPtr subscription_;
};

int main(int argc, char **argv) {
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<OwnAsr>());
    rclcpp::shutdown();
    return 0;
}
