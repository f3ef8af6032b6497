// Each look of the doctor, given what it would see: fit, not fit with the remedy, not visible.
#include "common/doctor.hpp"

#include <gtest/gtest.h>

#include <cerrno>

#include "common/doctor_link.hpp"
#include "common/doctor_machine.hpp"
#include "common/doctor_process.hpp"
#include "common/key_file.hpp"
#include "tests/support/temporary_file.hpp"
#include "tests/support/test_credentials.hpp"

namespace farhand::doctor {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;

// The files of a machine, below a root of its own.
class DoctorMachine : public testing::Test {
 protected:
  DoctorMachine() { fs::create_directories(root_); }
  ~DoctorMachine() override { fs::remove_all(root_); }
  void put(const fs::path& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  void put_cpu_flags(const std::string& flags) const {
    put("proc/cpuinfo", "processor\t: 0\nflags\t\t: " + flags + "\nbugs\t\t:\n");
  }

  fs::path root_ = fs::temp_directory_path() / ("farhand_root_" + std::to_string(getpid()));
};

void expect(const Finding& f, Level level, const std::string& part) {
  EXPECT_EQ(f.level, level) << f.text;
  EXPECT_NE(f.text.find(part), std::string::npos) << f.text;
}

TEST_F(DoctorMachine, WhatIsNotVisibleIsNoFault) {
  for (const Finding& f :
       {clock_source(root_), throttling(root_, 0.25), governor(root_, {0, 1}), memory(root_)})
    expect(f, Level::ok, "not visible");
  expect(virtual_machine(root_, stolen_time(root_), stolen_time(root_)), Level::ok, "no sign");
  EXPECT_FALSE(stolen_time(root_));
}

TEST_F(DoctorMachine, FirstLineHasNoEnd) {
  put("a", "one\ntwo\n");
  put("b", "");
  EXPECT_EQ(first_line(root_ / "a"), "one");
  EXPECT_EQ(first_line(root_ / "b"), "");
  EXPECT_FALSE(first_line(root_ / "c"));
}

TEST_F(DoctorMachine, ClockIsGoodInTheProcessorAndSlowInAChip) {
  const fs::path file = "sys/devices/system/clocksource/clocksource0/current_clocksource";
  for (const char* good : {"tsc\n", "kvm-clock\n", "arch_sys_counter\n"}) {
    put(file, good);
    EXPECT_EQ(clock_source(root_).level, Level::ok) << good;
  }
  for (const std::string bad : {"hpet", "acpi_pm", "jiffies"}) {
    put(file, bad + "\n");
    expect(clock_source(root_), Level::warning, bad + " is slow or coarse to read: boot with");
  }
}

TEST_F(DoctorMachine, ThrottlingMustLeaveTheLoopItsShare) {
  const fs::path file = "proc/sys/kernel/sched_rt_runtime_us";
  put(file, "950000\n");
  expect(throttling(root_, 0.95), Level::ok, "95 %");
  expect(throttling(root_, 0.951), Level::warning, "sysctl kernel.sched_rt_runtime_us=950000");
  put(file, "-1\n");
  expect(throttling(root_, 1), Level::ok, "off");
  put(file, "0\n");
  EXPECT_EQ(throttling(root_, 0.25).level, Level::warning);
  put(file, "950000\n");
  put("proc/sys/kernel/sched_rt_period_us", "10000000\n");
  expect(throttling(root_, 0.25), Level::warning, "sysctl kernel.sched_rt_runtime_us=9500000");
}

TEST_F(DoctorMachine, GovernorIsThatOfTheProcessorsUsed) {
  const std::string cpu = "sys/devices/system/cpu/cpu", file = "/cpufreq/scaling_governor";
  put(cpu + "0" + file, "powersave\n");
  put(cpu + "1" + file, "performance\n");
  put(cpu + "2" + file, "powersave\n");
  expect(governor(root_, {0, 1, 2}), Level::warning, "powersave on processor 0,2");
  expect(governor(root_, {1}), Level::ok, "performance on processor 1");
  expect(governor(root_, {1, 7}), Level::ok, "performance on processor 1");
  expect(governor(root_, {7}), Level::ok, "not visible");
}

TEST_F(DoctorMachine, ProcessorOfTheLoopIsThereAndItsOwn) {
  expect(processors(root_, {0, 1}, {}, 0), Level::ok, "0-1");
  expect(processors(root_, {3}, {}, 0), Level::warning, "a second one");
  expect(processors(root_, {0, 1}, 1, 0), Level::warning, "isolcpus=1");
  put("sys/devices/system/cpu/isolated", "1-2\n");
  expect(processors(root_, {0, 3}, 2, 0), Level::ok, "2 is isolated");
  expect(processors(root_, {0, 3}, 3, 0), Level::warning, "isolcpus=3");
  expect(processors(root_, {0, 1}, 1023, EINVAL), Level::problem, "there is no processor 1023");
}

TEST_F(DoctorMachine, MemoryIsWhatIsAvailable) {
  const auto meminfo = [](std::uint64_t kib) {
    return "MemTotal:   8000000 kB\nMemFree:    5 kB\nMemAvailable:  " + std::to_string(kib) +
           " kB\nSwapCached: 0 kB\n";
  };
  put("proc/meminfo", meminfo(kMemoryMiB * 1024));
  EXPECT_EQ(memory(root_).level, Level::ok);
  put("proc/meminfo", meminfo(kMemoryMiB * 1024 - 1));
  EXPECT_EQ(memory(root_).level, Level::warning);
  put("proc/meminfo", "MemTotal:   8000000 kB\n");
  expect(memory(root_), Level::ok, "not visible");
}

TEST_F(DoctorMachine, StolenTimeIsTheEighthFigureOfTheProcessorsTogether) {
  put("proc/stat", "cpu  1 2 3 4 5 6 7 8 100 100\ncpu0 9 9 9 9 9 9 9 9 9 9\n");
  const auto time = stolen_time(root_);
  ASSERT_TRUE(time);
  EXPECT_EQ(time->all, 36u);
  EXPECT_EQ(time->stolen, 8u);
  put("proc/stat", "cpu  1 2 3\n");
  EXPECT_FALSE(stolen_time(root_));
}

TEST_F(DoctorMachine, VirtualMachineIsKnownByWhatTellsIt) {
  const StolenTime before{1000, 10}, after{1200, 15};
  put_cpu_flags("fpu tsc hypervisors");
  expect(virtual_machine(root_, before, after), Level::ok, "no sign");
  put_cpu_flags("fpu tsc hypervisor");
  expect(virtual_machine(root_, before, after), Level::warning, "2.5 %");
  expect(virtual_machine(root_, {}, after), Level::warning, "not visible");
  put_cpu_flags("fpu tsc");
  put("sys/class/dmi/id/sys_vendor", "QEMU\n");
  expect(virtual_machine(root_, before, after), Level::warning, "QEMU");
  put("sys/hypervisor/type", "xen\n");
  expect(virtual_machine(root_, before, after), Level::warning, "xen");
}

TEST(DoctorProcess, WhatSlowsABuildIsNamed) {
  EXPECT_EQ(build({}).level, Level::ok);
  expect(build({.optimised = false}), Level::warning, "not optimised: run what");
  expect(build({.assertions = true, .sanitizer = true}), Level::warning,
         "assertions on, sanitizers on");
}

TEST(DoctorProcess, RefusalsComeWithTheirRemedy) {
  expect(scheduling(0, 80), Level::ok, "SCHED_FIFO at 80");
  expect(scheduling(EPERM, 80), Level::warning, "raise the rtprio limit");
  EXPECT_EQ(memory_lock(0).level, Level::ok);
  expect(memory_lock(ENOMEM), Level::warning, "raise the memlock limit");
  EXPECT_EQ(scheduling(EPERM, 80, Level::problem).level, Level::problem);
  EXPECT_EQ(memory_lock(ENOMEM, Level::problem).level, Level::problem);
}

TEST(DoctorProcess, WakeUpsAreJudgedByTheirPeriod) {
  const microseconds ms(1000);
  const auto level = [&](long median, long p99, long worst) {
    return wake_up({microseconds(median), microseconds(p99), microseconds(worst)}, ms).level;
  };
  EXPECT_EQ(level(50, 100, 500), Level::ok);
  EXPECT_EQ(level(50, 101, 500), Level::warning);
  EXPECT_EQ(level(50, 100, 501), Level::warning);
  expect(wake_up({microseconds(5), microseconds(60), microseconds(70)}, 2 * ms), Level::ok,
         "median 5.0 us late, 99 % 60.0 (limit 200), worst 70.0 (limit 1000)");
}

TEST(DoctorProcess, LatenessGrowsFromMedianToWorstAndIsNeverNegative) {
  const Lateness late = measure_lateness(microseconds(100), microseconds(20), 200);
  EXPECT_GE(late.median, Duration::zero());
  EXPECT_GE(late.p99, late.median);
  EXPECT_GE(late.worst, late.p99);
}

const std::string kSides =
    "master { twin_delta {} sim_hand {} } slave { sim_arm {} workspace {} joint_pid {} } ";

Findings look(const std::string& side, const std::string& text, ProgramOptions options = {}) {
  return link(side, options, parse_scene(kSides + text, "test"));
}

TEST(DoctorLink, AGoodSceneIsNamedWithItsMethods) {
  std::optional<Scene> scene;
  expect(scene_file(FARHAND_SOURCE_DIR "/deploy/scenes/twin_delta_far.textproto", scene), Level::ok,
         "handle twin_delta, device sim_hand, robot sim_arm, architecture position_force, "
         "compensation damped");
  EXPECT_TRUE(scene);
}

TEST(DoctorLink, ABrokenSceneIsAProblemWithItsPlace) {
  const TemporaryFile file("rate_hz: 5", ".textproto");
  std::optional<Scene> scene;
  expect(scene_file(file.path(), scene), Level::problem, ":1:10: rate_hz: 5 Hz is too small");
  EXPECT_FALSE(scene);
}

TEST(DoctorLink, AnAddressInUseIsAProblemOfTheSideThatWantsIt) {
  const UdpSocket taken(parse_udp_address("127.0.0.1:0"));
  const std::string text = "link { slave_address: \"" + to_string(taken.local()) + "\" }";
  expect(look("slave", text).front(), Level::problem, "another program has this port");
  expect(look("master", text).front(), Level::ok, "the slave's is " + to_string(taken.local()));
  expect(look("slave", text, {.listen = "127.0.0.1:0"}).front(), Level::ok, "can be bound");
}

TEST(DoctorLink, AnAddressThatIsNotOursOrBeyondAPlainLinkIsAProblem) {
  expect(look("slave", "", {.listen = "127.0.0.1:x"}).front(), Level::problem, "not an address");
  expect(look("slave", "", {.listen = "0.0.0.0:0"}).front(), Level::problem, "farhand-keygen");
  expect(look("slave",
              "link { slave_address: \"192.0.2.1:5\" master_address: \"0.0.0.0:0\" "
              "insecure: true }")
             .front(),
         Level::problem, "choose an address of this host");
}

TEST(DoctorLink, NothingIsSent) {
  UdpSocket slave(parse_udp_address("127.0.0.1:0"));
  ASSERT_EQ(look("master", "", {.slave = to_string(slave.local())}).front().level, Level::ok);
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  EXPECT_FALSE(slave.receive(buffer));
}

TEST(DoctorLink, KeyIsThereAndOnlyOurs) {
  const fs::path file =
      fs::temp_directory_path() / ("farhand_" + std::to_string(getpid()) + ".key");
  const Scene scene = parse_scene(kSides + "link { key_file: \"" + file.string() + "\" }", "test");
  expect(credentials(scene, DtlsRole::server), Level::problem, "farhand-keygen");
  const std::string name = write_new_key(file).name;
  expect(credentials(scene, DtlsRole::server), Level::ok, name);
  fs::permissions(file, fs::perms::others_read, fs::perm_options::add);
  expect(credentials(scene, DtlsRole::server), Level::problem, "chmod 600");
  fs::remove(file);
  expect(credentials(parse_scene(kSides, "test"), DtlsRole::server), Level::ok,
         "does not leave this machine");
  expect(credentials(parse_scene(kSides + "link { insecure: true }", "test"), DtlsRole::server),
         Level::warning, "insecure");
}

TEST(DoctorLink, CertificatesAreGoodForAWhile) {
  const auto look_at = [](DtlsRole role, int days) {
    const auto own = test_certificates(1, {"test side", "serverAuth", {.until = days}});
    const TemporaryFile a(to_pem(*own.authority)), c(to_pem(*own.own)), k(to_pem(*own.private_key));
    fs::permissions(k.path(), fs::perms::owner_read);
    const Scene scene = parse_scene(kSides + "link { certificates { authority_file: \"" + a.path() +
                                        "\" certificate_file: \"" + c.path() +
                                        "\" private_key_file: \"" + k.path() + "\" } }",
                                    "test");
    return credentials(scene, role);
  };
  expect(look_at(DtlsRole::server, 40), Level::ok, "valid until 20");
  expect(look_at(DtlsRole::server, 20), Level::warning, " days from now: make new ones");
  expect(look_at(DtlsRole::server, -1), Level::problem, "expired on");
  expect(look_at(DtlsRole::client, 40), Level::problem, "not for a master");
}

TEST(DoctorLink, ReceiveBufferHoldsWhatIsNotYetStale) {
  const proto::Scene scene;  // 1 kHz, stale after 20 ms: 20 datagrams
  EXPECT_EQ(receive_buffer(20 * 2304, scene).level, Level::ok);
  expect(receive_buffer(20 * 2304 - 1, scene), Level::warning, "rmem_default=46080");
}

TEST(DoctorLink, ASceneWithoutASlaveHasNoAddressAndIsNoneForASlave) {
  const Scene alone = parse_scene("master { falcon {} sim_hand {} position_control {} }", "test");
  expect(link("master", {}, alone).front(), Level::ok, "no slave");
  expect(link("slave", {}, alone).front(), Level::problem, "no slave");
  expect(link("master", {.slave = "127.0.0.1:1"}, alone).front(), Level::problem,
         "leave out --slave");
}

TEST(Doctor, PrintsALineEachAndCounts) {
  EXPECT_EQ(to_text({{Level::ok, "clock", "tsc"},
                     {Level::warning, "build", "slow: build"},
                     {Level::problem, "key", "gone: make"}}),
            "ok       clock           tsc\n"
            "warning  build           slow: build\n"
            "problem  key             gone: make\n"
            "1 problem, 1 warning\n");
  EXPECT_EQ(to_text({}), "0 problems, 0 warnings\n");
}

}  // namespace
}  // namespace farhand::doctor
