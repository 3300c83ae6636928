#include "binpick/drivers/usb_watcher.hpp"

#include <atomic>
#include <map>
#include <thread>
#include <vector>

#include "binpick/drivers/camera.hpp"
#include "usb/usb_device.hpp"

namespace binpick::drivers {
namespace {

// Its end wakes the thread; this is only how long it may sleep on.
constexpr timeval kSleep{60, 0};
constexpr auto kBothEvents = static_cast<libusb_hotplug_event>(LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED |
                                                               LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT);

}  // namespace

class UsbWatcher::Impl {
 public:
  explicit Impl(Callback callback) : callback_(std::move(callback)), context_(make_usb_context()) {
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0)
      throw SensorError("USB: the system does not tell when devices come and go");
    const int error = libusb_hotplug_register_callback(
        context_.get(), kBothEvents, LIBUSB_HOTPLUG_ENUMERATE, LIBUSB_HOTPLUG_MATCH_ANY,
        LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, on_event, this, &registration_);
    if (error != 0)
      throw SensorError(std::string("USB: no events of the bus: ") + libusb_strerror(error));
    // What is there already came within the registration.
    tell(false);
    thread_ = std::thread([this] { watch(); });
  }

  ~Impl() {
    end_ = true;
    libusb_interrupt_event_handler(context_.get());
    thread_.join();
    libusb_hotplug_deregister_callback(context_.get(), registration_);
  }

 private:
  struct Change {
    bool arrived;
    UsbDeviceRef device;
  };

  // Within libusb's event handling, where no device may be asked anything: noted for later.
  static int LIBUSB_CALL on_event(libusb_context*, libusb_device* device,
                                  libusb_hotplug_event event, void* self) {
    static_cast<Impl*>(self)->changes_.push_back(
        {event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, UsbDeviceRef(libusb_ref_device(device))});
    return 0;  // goes on
  }

  void watch() {
    while (!end_) {
      timeval sleep = kSleep;
      libusb_handle_events_timeout_completed(context_.get(), &sleep, nullptr);
      if (!end_) tell(true);
    }
  }

  void tell(bool aloud) {
    for (const Change& change : std::exchange(changes_, {})) {
      libusb_device* device = change.device.get();
      if (change.arrived) {
        const auto sensor = describe_usb_sensor(device);
        if (!sensor) continue;
        known_[device] = *sensor;
        if (aloud) callback_({true, *sensor});
      } else if (const auto gone = known_.extract(device); !gone.empty()) {
        if (aloud) callback_({false, gone.mapped()});
      }
    }
  }

  const Callback callback_;
  UsbContext context_;
  libusb_hotplug_callback_handle registration_{};
  std::vector<Change> changes_;
  std::map<libusb_device*, UsbSensor> known_;  // on the bus: libusb keeps their objects
  std::atomic<bool> end_{false};
  std::thread thread_;  // last: everything it uses is made before it
};

UsbWatcher::UsbWatcher(Callback callback) : impl_(std::make_unique<Impl>(std::move(callback))) {}
UsbWatcher::~UsbWatcher() = default;

}  // namespace binpick::drivers
