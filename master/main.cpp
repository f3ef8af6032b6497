// farhand-master: the operator's side. Arguments, scene, parts, loop.
#include <cstdio>
#include <optional>

#include "common/build_info.hpp"
#include "common/processors.hpp"
#include "common/program.hpp"
#include "common/scene_network.hpp"
#include "master/ahrs/line_fault.hpp"
#include "master/build.hpp"
#include "master/build_ahrs.hpp"
#include "master/falcon_usb/doctor.hpp"
#include "master/record.hpp"
#include "master/status.hpp"

int main(int argc, char** argv) {
  using namespace farhand;
  return run_program(
      argc, argv, "farhand-master", "the operator's side of a teleoperation",
      [](const ProgramOptions& options) {
        const Scene scene = load_scene(options.scene);
        if (print_only(options, scene, {{"master", master_stages(scene.proto)}})) return 0;
        const auto& realtime = scene.proto.master().realtime();
        if (realtime.has_cpu()) reserve_processor(static_cast<int>(realtime.cpu()));

        Master master(master_config(scene.proto));
        AnyDevice device = make_device(scene, options.trace, scene.proto.seed());
        std::optional<AhrsLine> ahrs;
        open_ahrs(scene.proto, ahrs);
        const MasterLoopConfig loop = master_loop_config(scene.proto);
        std::optional<MasterLink> link;
        std::optional<UdpSocket> socket;
        std::unique_ptr<SecureService> secure;
        if (!scene.proto.has_slave()) {
          refuse_addresses(options, scene);
        } else {
          socket.emplace(link_address(options.listen, scene.proto.link().master_address(), scene),
                         link_address(options.slave, scene.proto.link().slave_address(), scene));
          secure = make_secure(scene, socket->peer());
          LinkConfig config =
              link_config(scene, random_session(), secure ? &secure->channel() : nullptr);
          config.take_over = options.take_over;
          link.emplace(config);
        }
        std::optional<RecordingFile> file;
        std::optional<MasterRecording> recording;
        if (options.record) {
          file.emplace(*options.record, scene, about_program("master", build_info()),
                       std::vector{options.trace.value_or("")});
          recording.emplace(*file, scene.proto);
        }
        MasterStatus status(scene.shared_hash, options.quiet);
        Recorder<MasterRecord> recorder([&](const MasterRecord& r) {
          status.add(r);
          if (recording) recording->add(r);
          if (const auto news = advice(device)) status.advise(*news);
        });

        announce(scene,
                 socket ? "slave at " + to_string(*socket->peer()) + with_credentials(secure.get())
                        : "no slave in this scene");
        if (const auto& calibration = scene.proto.master().falcon_usb().calibration();
            !calibration.empty())
          status.advise("calibrated as " + calibration);
        start_realtime(realtime, is_real(device), kLoopPriority);
        MasterLoop(loop, master, device, link ? &*link : nullptr, socket ? &*socket : nullptr,
                   ahrs ? &*ahrs : nullptr, recorder)
            .run(options.limit());
        recorder.stop();
        std::fputs(status.final_table(recorder.lost()).c_str(), stdout);
        if (file) std::fputs(file->end().c_str(), stdout);
        return 0;
      },
      [](const Scene& scene) {
        doctor::Findings out = falcon_usb::examine(scene);
        for (auto& finding : examine_ahrs(scene)) out.push_back(std::move(finding));
        return out;
      });
}
