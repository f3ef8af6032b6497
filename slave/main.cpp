// farhand-slave: the robot's side. Arguments, scene, parts, loop.
#include <cstdio>
#include <optional>

#include "common/build_info.hpp"
#include "common/processors.hpp"
#include "common/program.hpp"
#include "common/scene_credentials.hpp"
#include "common/scene_network.hpp"
#include "slave/build.hpp"
#include "slave/observed.hpp"
#include "slave/record.hpp"
#include "slave/status.hpp"

int main(int argc, char** argv) {
  using namespace farhand;
  return run_program(
      argc, argv, "farhand-slave", "the robot's side of a teleoperation",
      [](const ProgramOptions& options) {
        const Scene scene = load_scene(options.scene);
        require_slave(scene);
        if (print_only(options, scene, {{"slave", slave_stages(scene.proto)}})) return 0;
        const auto& realtime = scene.proto.slave().realtime();
        if (realtime.has_cpu()) reserve_processor(static_cast<int>(realtime.cpu()));

        Slave slave(slave_config(scene.proto));
        AnyRobot robot = make_robot(scene.proto, scene.proto.seed());
        const SlaveLoopConfig loop = slave_loop_config(scene.proto);
        UdpSocket socket(link_address(options.listen, scene.proto.link().slave_address(), scene));
        const auto secure = make_secure(scene);
        SlaveLink link(link_config(scene, random_session(), secure ? &secure->channel() : nullptr));
        std::optional<RecordingFile> file;
        std::optional<SlaveRecording> recording;
        if (options.record) {
          file.emplace(*options.record, scene, about_program("slave", build_info()));
          recording.emplace(*file, slave.config());
        }
        std::optional<ObservedSlave> observed;
        if (const auto& at = scene.proto.link(); at.has_observer_address())
          observed.emplace(link_address({}, at.observer_address(), scene),
                           link_credentials(scene, DtlsRole::server), scene.shared_hash);
        SlaveStatus status(scene.shared_hash, options.quiet);
        Recorder<SlaveRecord> recorder([&](const SlaveRecord& r) {
          status.add(r);
          if (recording) recording->add(r);
          if (observed) observed->add(r);
        });

        announce(scene,
                 "listening on " + to_string(socket.local()) + with_credentials(secure.get()));
        start_realtime(realtime, is_real(robot), kSlaveLoopPriority);
        SlaveLoop(loop, slave, robot, link, socket, recorder).run(options.limit());
        recorder.stop();
        std::fputs(status.final_table(recorder.lost()).c_str(), stdout);
        if (file) std::fputs(file->end().c_str(), stdout);
        return 0;
      });
}
