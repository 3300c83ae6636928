// The USB bus as it is seen through the real libusb: who is there, what is wrong, who comes and
// goes.
#include "binpick/drivers/usb_bus.hpp"

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>

#include "binpick/drivers/sensor_list.hpp"
#include "binpick/drivers/usb_watcher.hpp"
#include "process_resources.hpp"
#include "u3v_bench.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;

TEST(UsbBus, ListsASensorWithItsPortAndSpeed) {
  U3vBench b({"--vendor", "Maker", "--model", "Cam 3"});
  const std::vector<UsbSensor> sensors = list_usb_sensors();
  ASSERT_EQ(sensors.size(), 1u);
  const UsbSensor& s = sensors.front();
  EXPECT_EQ(s.vendor, "Maker");
  EXPECT_EQ(s.model, "Cam 3");
  EXPECT_EQ(s.serial, "U1");
  EXPECT_EQ(s.uri(), "u3v://serial/U1");
  EXPECT_EQ(s.speed, UsbSpeed::kSuper);
  EXPECT_TRUE(s.super_speed_capable);
  EXPECT_EQ(s.port, "2-3");
  EXPECT_EQ(s.node, "/dev/bus/usb/002/002");
  EXPECT_EQ(s.access_fault, "");
  EXPECT_TRUE(usb_warnings(s).empty());
}

TEST(UsbBus, AsksTheDeviceForWhatTheKernelDoesNotKeep) {
  U3vBench b({"--vendor", "Maker", "--model", "Cam 3"});
  for (const char* name : {"manufacturer", "product", "serial"})
    std::filesystem::remove(b.folder + "/sys/bus/usb/devices/2-3/" + name);
  const std::vector<UsbSensor> sensors = list_usb_sensors();
  ASSERT_EQ(sensors.size(), 1u);
  EXPECT_EQ(sensors[0].vendor, "Maker");
  EXPECT_EQ(sensors[0].model, "Cam 3");
  EXPECT_EQ(sensors[0].serial, "U1");
}

TEST(UsbBus, WarnsOfAUsb3SensorInAPortOfUsb2) {
  U3vBench b({"--usb2"});
  const std::vector<UsbSensor> sensors = list_usb_sensors();
  ASSERT_EQ(sensors.size(), 1u);
  EXPECT_EQ(sensors[0].speed, UsbSpeed::kHigh);
  EXPECT_EQ(sensors[0].port, "1-3");
  const std::vector<std::string> warnings = usb_warnings(sensors[0]);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "U1: a USB 3 sensor runs at 480 Mbit/s at port 1-3: use a USB 3 port, and a cable and "
            "hubs made for it");
}

TEST(UsbBus, DoesNotWarnOfASensorThatKnowsNoHigherSpeed) {
  UsbSensor s;
  s.serial = "S";
  s.speed = UsbSpeed::kHigh;
  s.super_speed_capable = false;
  EXPECT_TRUE(usb_warnings(s).empty());
  s.super_speed_capable = true;
  EXPECT_EQ(usb_warnings(s).size(), 1u);
  s.speed = UsbSpeed::kUnknown;
  EXPECT_TRUE(usb_warnings(s).empty());
  s.serial.clear();
  s.port = "2-1";
  ASSERT_EQ(usb_warnings(s).size(), 1u);
  EXPECT_EQ(usb_warnings(s)[0].find("2-1: "), 0u);
}

// From here on the permissions of files bind also a test that is started by root.
void give_up_privileges() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[2] = {};
  ASSERT_EQ(syscall(SYS_capget, &header, data), 0);
  data[0].effective &= ~((1u << CAP_DAC_OVERRIDE) | (1u << CAP_DAC_READ_SEARCH));
  ASSERT_EQ(syscall(SYS_capset, &header, data), 0);
}

TEST(UsbBus, NamesTheUdevRuleWhereTheSensorMayNotBeOpened) {
  U3vBench b;
  give_up_privileges();
  std::filesystem::permissions(b.folder + "/dev/bus/usb/002/002", std::filesystem::perms::none);
  const std::vector<UsbSensor> sensors = list_usb_sensors();
  ASSERT_EQ(sensors.size(), 1u);
  // Who it is, is known all the same.
  EXPECT_EQ(sensors[0].serial, "U1");
  EXPECT_NE(sensors[0].access_fault.find("60-binpick-usb.rules"), std::string::npos);
  ASSERT_EQ(usb_warnings(sensors[0]).size(), 1u);
  const auto expect_named = [](const auto& access) {
    try {
      access();
      FAIL() << "no error";
    } catch (const SensorError& e) {
      EXPECT_NE(std::string(e.what()).find("60-binpick-usb.rules"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("/dev/bus/usb/002/002"), std::string::npos) << e.what();
    }
  };
  expect_named([&] { open_camera(b.spec); });
  expect_named([&] { read_sensor_report(b.spec.uri); });
  expect_named([] { reset_usb_port("U1"); });
}

TEST(UsbBus, ResetsThePortBySerialAndByPort) {
  U3vBench b;
  reset_usb_port("U1");
  EXPECT_EQ(b.sim->counter("resets"), 1);
  reset_usb_port("2-3");
  EXPECT_EQ(b.sim->counter("resets"), 2);
  EXPECT_THROW(reset_usb_port("U2"), SensorError);
  EXPECT_THROW(reset_usb_port("2-4"), SensorError);
  EXPECT_EQ(b.sim->counter("resets"), 2);
}

TEST(UsbBus, DoesNotTakeTheSensorFromWhoUsesIt) {
  U3vBench b;
  b.open();
  try {
    reset_usb_port("U1");
    FAIL() << "no error";
  } catch (const SensorError& e) {
    EXPECT_NE(std::string(e.what()).find("another program is using"), std::string::npos);
  }
  EXPECT_EQ(list_usb_sensors().size(), 1u);
  EXPECT_EQ(b.sim->counter("resets"), 0);
  ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
  EXPECT_TRUE(b.camera->wait_frame(U3vBench::Clock::now() + 10s).ok());
  b.camera.reset();
  reset_usb_port("U1");
  EXPECT_EQ(b.sim->counter("resets"), 1);
}

// As the kernel does: who has the sensor open loses what was under way, and its claim.
TEST(UsbBus, AResetInUseEndsWhatIsUnderWay) {
  U3vBench b;
  b.open();
  ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
  ASSERT_TRUE(b.camera->wait_frame(U3vBench::Clock::now() + 10s).ok());
  b.tell("fault hung 1");
  std::atomic<bool> back{false};
  std::thread caller([&] {
    EXPECT_NE(b.camera->trigger().code, ErrorCode::kNone);
    back = true;
  });
  std::this_thread::sleep_for(300ms);
  EXPECT_FALSE(back) << "a hung sensor answers nothing";
  reset_usb_port("U1", true);
  const auto begun = U3vBench::Clock::now();
  caller.join();
  EXPECT_EQ(b.camera->trigger().code, ErrorCode::kSensorLost);
  b.camera->stop();
  const double took_s = std::chrono::duration<double>(U3vBench::Clock::now() - begun).count();
  std::printf("[ measured ] free %.2f s after the reset\n", took_s);
  EXPECT_LT(took_s, 3);
  b.camera.reset();
  b.open();
  ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
  EXPECT_TRUE(b.camera->wait_frame(U3vBench::Clock::now() + 10s).ok());
}

class EventLog {
 public:
  void add(const UsbEvent& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
  }
  std::vector<UsbEvent> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, 10s, [&] { return events_.size() >= count; });
    return events_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<UsbEvent> events_;
};

TEST(UsbWatcher, TellsWhoLeavesAndWhoArrives) {
  U3vBench b;
  EventLog log;
  const UsbWatcher watcher([&log](const UsbEvent& event) { log.add(event); });
  b.tell("unplug");
  std::vector<UsbEvent> events = log.wait_for(1);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_FALSE(events[0].arrived);
  EXPECT_EQ(events[0].sensor.serial, "U1");
  EXPECT_EQ(events[0].sensor.port, "2-3");
  EXPECT_TRUE(list_usb_sensors().empty());
  b.tell("plug");
  events = log.wait_for(2);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_TRUE(events[1].arrived);
  EXPECT_EQ(events[1].sensor.serial, "U1");
  EXPECT_EQ(events[1].sensor.node, "/dev/bus/usb/002/003");
  EXPECT_EQ(events[1].sensor.access_fault, "");
}

TEST(UsbWatcher, EndsWithoutLeavingAnythingBehind) {
  U3vBench b;
  const auto cycle = [] { const UsbWatcher watcher([](const UsbEvent&) {}); };
  for (int i = 0; i < 3; ++i) cycle();
  const int threads = entries_of("/proc/self/task"), descriptors = entries_of("/proc/self/fd");
  for (int i = 0; i < 100; ++i) cycle();
  EXPECT_EQ(threads_at_last(threads), threads);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
}

TEST(UsbWatcher, TellsNothingAfterItsEnd) {
  U3vBench b;
  EventLog log;
  {
    const UsbWatcher watcher([&log](const UsbEvent& event) { log.add(event); });
  }
  EventLog other;
  const UsbWatcher second([&other](const UsbEvent& event) { other.add(event); });
  b.tell("unplug");
  EXPECT_EQ(other.wait_for(1).size(), 1u);
  EXPECT_TRUE(log.wait_for(0).empty());
}

TEST(UsbfsMemory, IsReadFromTheKernel) {
  U3vBench b({"--usbfs-memory-mb", "48"});
  EXPECT_EQ(usbfs_memory_limit_mib(), 48);
}

TEST(UsbfsMemory, AdviceSaysWhatToSet) {
  EXPECT_EQ(usbfs_memory_advice(-1, 2), "");
  EXPECT_EQ(usbfs_memory_advice(0, 2), "");
  EXPECT_EQ(usbfs_memory_advice(16, 1), "");
  EXPECT_EQ(usbfs_memory_advice(17, 2), "");
  const std::string advice = usbfs_memory_advice(16, 2);
  EXPECT_NE(advice.find("2 USB sensors take 17 MiB"), std::string::npos) << advice;
  EXPECT_NE(advice.find("limit is 16"), std::string::npos) << advice;
  EXPECT_NE(advice.find("usbcore.usbfs_memory_mb=64"), std::string::npos) << advice;
}

}  // namespace
}  // namespace binpick::drivers
