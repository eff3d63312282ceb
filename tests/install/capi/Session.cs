// Surveys a stream that feed wrote, by the C interface, and prints its stations, all at the end,
// survey.csv and the verdict: Session JOB STREAM
using System;
using System.IO;
using System.Runtime.InteropServices;
using System.Text;

static class Session {
  const string Library = "libwellgyro_c.so.1";
  const int ImuBytes = 120, DepthBytes = 48, StationBytes = 344;

  [DllImport(Library)] static extern int wellgyro_open(string path, out IntPtr session);
  [DllImport(Library)] static extern int wellgyro_push_imu(IntPtr s, byte[] samples, UIntPtr count);
  [DllImport(Library)] static extern int wellgyro_push_depth(IntPtr s, byte[] marks, UIntPtr count);
  [DllImport(Library)] static extern int wellgyro_poll_directed(
      IntPtr s, byte[] stations, UIntPtr capacity, out UIntPtr count);
  [DllImport(Library)] static extern long wellgyro_refused(IntPtr s);
  [DllImport(Library)] static extern int wellgyro_adjust(IntPtr s);
  [DllImport(Library)] static extern int wellgyro_finish(IntPtr s);
  [DllImport(Library)] static extern int wellgyro_survey_csv(IntPtr s, int tool, byte[] text,
                                                             UIntPtr capacity, out UIntPtr size);
  [DllImport(Library)] static extern int wellgyro_verdict(IntPtr s, int tool, out int verdict,
                                                          byte[] causes, UIntPtr capacity,
                                                          out UIntPtr size);
  [DllImport(Library)] static extern IntPtr wellgyro_error(IntPtr s);
  [DllImport(Library)] static extern void wellgyro_close(IntPtr s);

  static int Push(IntPtr session, BinaryReader stream) {
    var one = new UIntPtr(1);
    while (stream.BaseStream.Position < stream.BaseStream.Length) {
      int answer = stream.ReadInt32() == 0
          ? wellgyro_push_imu(session, stream.ReadBytes(ImuBytes), one)
          : wellgyro_push_depth(session, stream.ReadBytes(DepthBytes), one);
      if (answer != 0) return answer;
    }
    if (wellgyro_refused(session) != 0) return 2;
    int adjusted = wellgyro_adjust(session);
    return adjusted != 0 ? adjusted : wellgyro_finish(session);
  }

  static int Poll(IntPtr session, StreamWriter lines) {
    var stations = new byte[1000 * StationBytes];
    for (;;) {
      UIntPtr count;
      int answer = wellgyro_poll_directed(session, stations, new UIntPtr(1000), out count);
      if (answer != 0 || (int)count == 0) return answer;
      for (int at = 0; at < (int)count * StationBytes; at += 8) {
        lines.Write("{0:X16} ", BitConverter.ToInt64(stations, at));
        if (at % StationBytes == StationBytes - 8) lines.Write("\n");
      }
    }
  }

  static int Judge(IntPtr session, Stream output) {
    var causes = new byte[4096];
    int verdict;
    UIntPtr size;
    int answer = wellgyro_verdict(session, 0, out verdict, causes, new UIntPtr(4096), out size);
    if (answer != 0) return answer;
    var line = Encoding.UTF8.GetBytes(verdict + " ");
    output.Write(line, 0, line.Length);
    causes[(int)size - 1] = (byte)'\n';
    output.Write(causes, 0, (int)size);
    return answer;
  }

  static int Print(IntPtr session) {
    var output = Console.OpenStandardOutput();
    using (var lines = new StreamWriter(output, new UTF8Encoding(false), 4096, true)) {
      int polled = Poll(session, lines);
      if (polled != 0) return polled;
    }
    UIntPtr size;
    int answer = wellgyro_survey_csv(session, 0, null, UIntPtr.Zero, out size);
    if (answer != 1) return answer;
    var text = new byte[(int)size];
    answer = wellgyro_survey_csv(session, 0, text, size, out size);
    if (answer != 0) return answer;
    output.Write(text, 0, text.Length - 1);
    return Judge(session, output);
  }

  static int Main(string[] arguments) {
    IntPtr session;
    int answer = wellgyro_open(arguments[0], out session);
    using (var stream = new BinaryReader(File.OpenRead(arguments[1]))) {
      if (answer == 0) answer = Push(session, stream);
    }
    if (answer == 0) answer = Print(session);
    if (answer != 0) Console.Error.WriteLine(Marshal.PtrToStringAnsi(wellgyro_error(session)));
    wellgyro_close(session);
    return answer;
  }
}
